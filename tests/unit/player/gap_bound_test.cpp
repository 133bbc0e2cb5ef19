#include "player/gap_bound.h"

#include <gtest/gtest.h>

namespace vpslam {
namespace {

TEST(GapBound, LeavesTimeAloneWithoutLongGaps) {
  GapBound bound;
  for (const int64_t stamp_us : {-5'000'000, 0, 33'000, 4'900'000}) {
    EXPECT_EQ(bound.TimeOf(stamp_us), stamp_us);
    EXPECT_EQ(bound.newest_gap_us(), 0);
  }
}

TEST(GapBound, ShortensALongGapAndMovesWhatFollows) {
  GapBound bound;
  EXPECT_EQ(bound.TimeOf(1'000'000), 1'000'000);
  EXPECT_EQ(bound.TimeOf(3'601'000'000), 6'000'000);
  EXPECT_EQ(bound.newest_gap_us(), 3'600'000'000);
  EXPECT_EQ(bound.TimeOf(3'601'033'000), 6'033'000);
  EXPECT_EQ(bound.newest_gap_us(), 0);
  EXPECT_EQ(bound.TimeOf(1'785'000'000'000'000), 11'033'000);
  EXPECT_EQ(bound.count(), 2);
}

}  // namespace
}  // namespace vpslam
