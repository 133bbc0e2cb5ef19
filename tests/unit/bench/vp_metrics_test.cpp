#include "bench/vp_metrics.h"

#include <numbers>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "core/geometry/so3.h"

namespace vpslam {
namespace {

constexpr double kRad = std::numbers::pi / 180;

TEST(VpMetricsTest, SignsAndOrderAreFree) {
  const Eigen::Matrix3d truth = ExpSo3({0.3, -0.2, 0.9}).toRotationMatrix();
  Eigen::Matrix3d found;
  found << truth.col(2), -truth.col(0), truth.col(1);
  EXPECT_NEAR(DirectionErrors_deg(found, truth).norm(), 0, 1e-6);
  found.col(0) *= -1;  // a rotation again
  if (found.determinant() < 0) found.col(1) *= -1;
  EXPECT_NEAR(RotationError_deg(found, truth), 0, 1e-6);
}

TEST(VpMetricsTest, FiguresAreRightForAKnownTurn) {
  const Eigen::Matrix3d truth = Eigen::Matrix3d::Identity();
  VpErrors errors;
  // About the third axis: errors of 2, 2 and 0 degrees.
  errors.Add(ExpSo3({0, 0, 2 * kRad}).toRotationMatrix(), truth);
  EXPECT_NEAR(errors.MedianRotation_deg(), 2, 1e-9);
  EXPECT_NEAR(errors.AA(3), 100 * (1.0 / 3 + 1.0 / 3 + 1) / 3, 1e-9);
  EXPECT_NEAR(errors.AA(10), 100 * (0.8 + 0.8 + 1) / 3, 1e-9);
  EXPECT_NEAR(errors.MeanCapped_deg(), 4.0 / 3, 1e-9);
  EXPECT_EQ(errors.ShareOver5_percent(), 0);
  errors.Add(ExpSo3({0, 0, 20 * kRad}).toRotationMatrix(), truth);
  EXPECT_NEAR(errors.AA(10), 0.5 * 100 * (0.8 + 0.8 + 1) / 3 + 0.5 * 100.0 / 3, 1e-9);
  EXPECT_NEAR(errors.MeanCapped_deg(), 0.5 * 4.0 / 3 + 0.5 * 20.0 / 3, 1e-9);
  EXPECT_EQ(errors.ShareOver5_percent(), 50);
}

TEST(VpMetricsTest, MedianOfEvenAndOdd) {
  EXPECT_EQ(Median({3, 1, 2}), 2);
  EXPECT_EQ(Median({4, 1, 2, 3}), 2.5);
}

}  // namespace
}  // namespace vpslam
