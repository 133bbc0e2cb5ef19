#include "player/bad_frame_guard.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vpslam {
namespace {

using ::testing::HasSubstr;
using ::testing::Optional;

TEST(BadFrameGuard, SkipsSingleBadFramesOfALongSequence) {
  BadFrameGuard guard(1000);
  for (int i = 0; i < 1000; ++i) {
    if (i % 21 == 20) {
      EXPECT_EQ(guard.CountBad(), std::nullopt) << i;
    } else {
      guard.CountGood();
    }
  }
  EXPECT_EQ(guard.bad(), 47);
  EXPECT_EQ(guard.good(), 953);
}

TEST(BadFrameGuard, GivesUpOnABadStart) {
  BadFrameGuard guard(1000);
  EXPECT_EQ(guard.CountBad(), std::nullopt);
  EXPECT_EQ(guard.CountBad(), std::nullopt);
  EXPECT_THAT(guard.CountBad(), Optional(HasSubstr("first 3")));
}

TEST(BadFrameGuard, GivesUpOnAGap) {
  BadFrameGuard guard(0);
  guard.CountGood();
  for (int i = 0; i < 5; ++i) EXPECT_EQ(guard.CountBad(), std::nullopt);
  EXPECT_THAT(guard.CountBad(), Optional(HasSubstr("6 images in a row")));
}

TEST(BadFrameGuard, GivesUpBeyondTheFraction) {
  BadFrameGuard guard(40);
  for (int i = 0; i < 2; ++i) {
    guard.CountGood();
    EXPECT_EQ(guard.CountBad(), std::nullopt);
  }
  guard.CountGood();
  EXPECT_THAT(guard.CountBad(), Optional(HasSubstr("3 of 40")));
}

TEST(BadFrameGuard, GivesUpWhenNothingIsLeft) {
  BadFrameGuard one(1);
  EXPECT_NE(one.CountBad(), std::nullopt);
  BadFrameGuard two(2);
  EXPECT_EQ(two.CountBad(), std::nullopt);
  EXPECT_NE(two.CountBad(), std::nullopt);
}

}  // namespace
}  // namespace vpslam
