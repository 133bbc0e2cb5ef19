#include "core/geometry/image_mask.h"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vpslam {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// The lower half of an image of 8 x 6 px.
ImageMask LowerHalf() { return ImageMask(std::vector<int32_t>{24, 24}, 8, 6); }

TEST(MaskRuns, AlternateBetweenSeenAndHidden) {
  EXPECT_THAT(MaskRuns(std::vector<uint8_t>{0, 0, 9, 9, 9, 0}), ElementsAre(2, 3, 1));
  EXPECT_THAT(MaskRuns(std::vector<uint8_t>{1, 0}), ElementsAre(0, 1, 1));
  EXPECT_THAT(MaskRuns(std::vector<uint8_t>{1, 1}), ElementsAre(0, 2));
  EXPECT_THAT(MaskRuns(std::vector<uint8_t>{0, 0}), IsEmpty());
  EXPECT_THAT(MaskRuns({}), IsEmpty());
}

TEST(MaskRuns, HoldEveryPixel) {
  std::mt19937 rng(1);
  for (int trial = 0; trial < 100; ++trial) {
    const int width = 1 + static_cast<int>(rng() % 9), height = 1 + static_cast<int>(rng() % 9);
    std::vector<uint8_t> hidden(static_cast<std::size_t>(width * height));
    for (uint8_t& value : hidden) value = rng() % 3 == 0;
    hidden.front() = 0;
    hidden.back() = 1;
    if (hidden.size() == 1) continue;
    const auto runs = MaskRuns(hidden);
    ASSERT_EQ(ImageMask::Fault(runs, width, height), std::nullopt);
    EXPECT_EQ(ImageMask(runs, width, height).hidden(), hidden);
  }
}

TEST(ImageMask, RefusesWhatIsNoMask) {
  const auto fault = [](const std::vector<int32_t>& runs) {
    return ImageMask::Fault(runs, 8, 6).value_or("");
  };
  EXPECT_EQ(fault({}), "");
  EXPECT_EQ(fault({24, 24}), "");
  EXPECT_EQ(fault({0, 1, 47}), "");
  EXPECT_THAT(fault({24, 25}), HasSubstr("size"));
  EXPECT_THAT(fault({24}), HasSubstr("size"));
  EXPECT_THAT(fault({24, 0, 24}), HasSubstr("empty run"));
  EXPECT_THAT(fault({-1, 49}), HasSubstr("empty run"));
  EXPECT_THAT(fault({0, 48}), HasSubstr("whole image"));
  EXPECT_THAT(fault({2147483647, 2147483647, 2147483647}), HasSubstr("size"));
  EXPECT_THAT(fault(std::vector<int32_t>(ImageMask::kMaxRuns + 1, 1)), HasSubstr("ragged"));
}

TEST(ImageMask, HidesPixelsAroundTheirCentres) {
  const ImageMask mask = LowerHalf();
  EXPECT_FALSE(mask.Hides({3, 2.4}));
  EXPECT_TRUE(mask.Hides({3, 2.6}));
  EXPECT_TRUE(mask.Hides({7.4, 5.4}));
  for (const Eigen::Vector2d& outside : {Eigen::Vector2d(-1, 4), Eigen::Vector2d(8, 4),
                                         Eigen::Vector2d(4, 6), Eigen::Vector2d(NAN, 4)}) {
    EXPECT_FALSE(mask.Hides(outside));
  }
  EXPECT_FALSE(ImageMask({}, 8, 6).Hides({3, 5}));
}

TEST(ImageMask, IsScaledWithTheImage) {
  EXPECT_THAT(LowerHalf().Scaled(4, 2), ElementsAre(4, 4));
  EXPECT_THAT(LowerHalf().Scaled(16, 12), ElementsAre(96, 96));
  EXPECT_THAT(ImageMask({}, 8, 6).Scaled(4, 3), IsEmpty());
}

TEST(LongestSeenPart, EndsBeforeWhatIsHidden) {
  const ImageMask mask = LowerHalf();
  const auto whole = LongestSeenPart(mask, {1, 1}, {6, 1}, 1);
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->start_px, Eigen::Vector2d(1, 1));
  EXPECT_EQ(whole->end_px, Eigen::Vector2d(6, 1));
  const auto upper = LongestSeenPart(mask, {2, 0}, {2, 5}, 0.5);
  ASSERT_TRUE(upper);
  EXPECT_EQ(upper->start_px, Eigen::Vector2d(2, 0));
  EXPECT_LE(upper->end_px.y(), 2.0);
  EXPECT_GE(upper->end_px.y(), 1.4);
  EXPECT_FALSE(LongestSeenPart(mask, {2, 3}, {2, 5}, 0.5));
  EXPECT_FALSE(LongestSeenPart(mask, {2, 2}, {2, 5}, 1)) << "no more than the margin is seen";
}

TEST(LongestSeenPart, IsTheLongerOfTwo) {
  // Columns 3 and 4 of 10 are hidden.
  std::vector<uint8_t> hidden(100);
  for (std::size_t i = 0; i < 100; ++i) hidden[i] = i % 10 == 3 || i % 10 == 4;
  const ImageMask mask(MaskRuns(hidden), 10, 10);
  const auto part = LongestSeenPart(mask, {0, 5}, {9, 5}, 0);
  ASSERT_TRUE(part);
  EXPECT_NEAR(part->start_px.x(), 4.5, 0.51);
  EXPECT_EQ(part->end_px.x(), 9);
}

}  // namespace
}  // namespace vpslam
