#include "player/truth_track.h"

#include <gtest/gtest.h>

namespace vpslam {
namespace {

SE3 At(double x) { return SE3(Eigen::Quaterniond::Identity(), {x, 0, 0}); }

TEST(TruthTrack, TakesTheNearestWithinTheTolerance) {
  TruthTrack track;
  EXPECT_FALSE(track.Nearest(0));
  track.Add(200'000, At(2));
  track.Add(0, At(0));
  track.Add(100'000, At(1));
  EXPECT_EQ(track.Nearest(0)->translation.x(), 0);
  EXPECT_EQ(track.Nearest(-20'000)->translation.x(), 0);
  EXPECT_FALSE(track.Nearest(-20'001));
  EXPECT_EQ(track.Nearest(80'000)->translation.x(), 1);
  EXPECT_EQ(track.Nearest(119'999)->translation.x(), 1);
  EXPECT_FALSE(track.Nearest(150'000));
  EXPECT_EQ(track.Nearest(150'001, 50'000)->translation.x(), 2);
  EXPECT_EQ(track.Nearest(215'000)->translation.x(), 2);
  EXPECT_FALSE(track.Nearest(300'000));
}

}  // namespace
}  // namespace vpslam
