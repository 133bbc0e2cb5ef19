#include "core/geometry/se3.h"

#include <random>

#include <gtest/gtest.h>

namespace vpslam {
namespace {

Eigen::Vector3d RandomVector(std::mt19937& rng, double sigma) {
  std::normal_distribution<double> normal(0.0, sigma);
  return {normal(rng), normal(rng), normal(rng)};
}

SE3 RandomPose(std::mt19937& rng) {
  return SE3(ExpSo3(RandomVector(rng, 1.0)), RandomVector(rng, 3.0));
}

TEST(So3, LogInvertsExp) {
  std::mt19937 rng(1);
  for (int i = 0; i < 1000; ++i) {
    Eigen::Vector3d w = RandomVector(rng, 1.0).normalized() * (3.1415 * (i % 100) / 100.0);
    if (i < 50) w = RandomVector(rng, 1.0) * std::pow(10.0, -i / 3.0);
    if (w.norm() > 3.14) continue;
    EXPECT_NEAR((LogSo3(ExpSo3(w)) - w).norm(), 0.0, 1e-9) << w.transpose();
  }
}

TEST(So3, ExpHasTheRightSenseAndAngle) {
  const Eigen::Vector3d x = ExpSo3({0, 0, M_PI / 2}) * Eigen::Vector3d::UnitX();
  EXPECT_NEAR((x - Eigen::Vector3d::UnitY()).norm(), 0.0, 1e-12);
  EXPECT_NEAR(AngleBetween_rad(ExpSo3({0.3, 0, 0}), ExpSo3({-0.2, 0, 0})), 0.5, 1e-12);
}

TEST(Se3, GroupIdentities) {
  std::mt19937 rng(2);
  for (int i = 0; i < 100; ++i) {
    const SE3 b_from_a = RandomPose(rng), c_from_b = RandomPose(rng);
    const Eigen::Vector3d x = RandomVector(rng, 5.0);
    EXPECT_NEAR((c_from_b * b_from_a * x - c_from_b * (b_from_a * x)).norm(), 0.0, 1e-9);
    EXPECT_NEAR((b_from_a.Inverse() * (b_from_a * x) - x).norm(), 0.0, 1e-9);
    EXPECT_NEAR((b_from_a * b_from_a.Center()).norm(), 0.0, 1e-9);
  }
}

TEST(Se3, LocalCoordinatesInvertRetract) {
  std::mt19937 rng(3);
  for (int i = 0; i < 100; ++i) {
    const SE3 from = RandomPose(rng), to = RandomPose(rng);
    const SE3 back = Retract(from, LocalCoordinates(from, to));
    EXPECT_NEAR((back.translation - to.translation).norm(), 0.0, 1e-9);
    EXPECT_NEAR(AngleBetween_rad(back.rotation, to.rotation), 0.0, 1e-9);
  }
}

TEST(Se3, RetractMovesAPointAsTheHeaderSays) {
  std::mt19937 rng(4);
  const SE3 pose = RandomPose(rng);
  const Eigen::Vector3d x = RandomVector(rng, 2.0);
  const Eigen::Vector3d in_b = pose * x;
  constexpr double kStep = 1e-6;
  for (int k = 0; k < 6; ++k) {
    Vector6d xi = Vector6d::Zero();
    xi[k] = kStep;
    const Eigen::Vector3d numeric = (Retract(pose, xi) * x - Retract(pose, -xi) * x) / (2 * kStep);
    const Eigen::Vector3d expected =
        k < 3 ? Eigen::Vector3d(Eigen::Vector3d::Unit(k))
              : Eigen::Vector3d(Eigen::Vector3d::Unit(k - 3).cross(in_b));
    EXPECT_NEAR((numeric - expected).norm(), 0.0, 1e-7);
  }
}

}  // namespace
}  // namespace vpslam
