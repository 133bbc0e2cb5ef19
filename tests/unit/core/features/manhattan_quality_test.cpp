#include "core/features/manhattan_quality.h"

#include <limits>

#include <gtest/gtest.h>

#include "core/geometry/so3.h"

namespace vpslam {
namespace {

/// Sigmas of 0.01, 0.005 and 0.02 rad about axes that are not the camera's.
LineSet Lines(int first, int second, int third) {
  LineSet lines;
  lines.manhattan = ManhattanState::kThree;
  for (const int support : {first, second, third, 50}) {
    lines.vanishing_points.push_back({.support = support});
  }
  const Eigen::Matrix3d r = ExpSo3({0.4, -0.7, 1.1}).toRotationMatrix();
  lines.covariance_rad2 = r * Eigen::Vector3d(1e-4, 2.5e-5, 4e-4).asDiagonal() * r.transpose();
  return lines;
}

TEST(WorstVariance, IsAboutTheWorstAxis) {
  EXPECT_NEAR(WorstVariance(Lines(9, 9, 9).covariance_rad2), 4e-4, 1e-12);
}

TEST(IsSoundManhattan, NeedsTwoSupportedAxes) {
  EXPECT_TRUE(IsSoundManhattan(Lines(5, 5, 5), 5, 0.03));
  EXPECT_TRUE(IsSoundManhattan(Lines(5, 0, 5), 5, 0.03));
  EXPECT_TRUE(IsSoundManhattan(Lines(0, 5, 5), 5, 0.03));
  // Further directions are no axes, however many lines they have.
  EXPECT_FALSE(IsSoundManhattan(Lines(5, 4, 4), 5, 0.03));
  EXPECT_FALSE(IsSoundManhattan(Lines(100, 0, 0), 5, 0.03));
}

TEST(IsSoundManhattan, OnlyOfAFrameThatThereIs) {
  LineSet lines = Lines(9, 9, 9);
  lines.manhattan = ManhattanState::kTwo;
  EXPECT_TRUE(IsSoundManhattan(lines, 5, 0.03));
  lines.manhattan = ManhattanState::kNone;
  EXPECT_FALSE(IsSoundManhattan(lines, 5, 0.03));
  lines = Lines(9, 9, 9);
  lines.vanishing_points.resize(2);
  EXPECT_TRUE(IsSoundManhattan(lines, 5, 0.03));
  lines.vanishing_points.resize(1);
  EXPECT_FALSE(IsSoundManhattan(lines, 5, 0.03));
  EXPECT_FALSE(IsSoundManhattan(LineSet(), 0, 1));
}

TEST(IsSoundManhattan, TheWorstDirectionDecides) {
  EXPECT_TRUE(IsSoundManhattan(Lines(9, 9, 9), 5, 0.0201));
  EXPECT_FALSE(IsSoundManhattan(Lines(9, 9, 9), 5, 0.0199));
  LineSet lines = Lines(9, 9, 9);
  lines.covariance_rad2(1, 2) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(IsSoundManhattan(lines, 5, 1));
  lines.covariance_rad2.setConstant(std::numeric_limits<double>::infinity());
  EXPECT_FALSE(IsSoundManhattan(lines, 5, 1));
}

}  // namespace
}  // namespace vpslam
