#include "core/estimation/point_cost.h"

#include <random>

#include <gtest/gtest.h>

#include "core/estimation/se3_manifold.h"
#include "tests/unit/test_camera.h"

namespace vpslam {
namespace {

Eigen::Vector2d Residual(const PointCost& cost, const PoseParameters& pose,
                         const Eigen::Vector3d& point) {
  const double* parameters[] = {pose.data(), point.data()};
  Eigen::Vector2d residual;
  EXPECT_TRUE(cost.Evaluate(parameters, residual.data(), nullptr));
  return residual;
}

TEST(PointCost, JacobiansAgreeWithNumericOnes) {
  const Camera camera = TestCamera();
  const Se3Manifold manifold;
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const auto vector = [&] { return Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng)); };
  for (int trial = 0; trial < 200; ++trial) {
    const SE3 pose(ExpSo3(vector()), vector());
    const Eigen::Vector3d in_cam = vector() + Eigen::Vector3d(0, 0, 3);
    const Eigen::Vector3d point = pose.Inverse() * in_cam;
    Eigen::Matrix2d sqrt_information;
    sqrt_information << 0.7, 0.3, 0.3, 0.2;
    const PointCost cost(camera, {300, 200}, sqrt_information);
    const PoseParameters x = ToParameters(pose);
    const double* parameters[] = {x.data(), point.data()};
    Eigen::Vector2d residual;
    Eigen::Matrix<double, 2, 7, Eigen::RowMajor> by_pose;
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> by_point;
    double* jacobians[] = {by_pose.data(), by_point.data()};
    ASSERT_TRUE(cost.Evaluate(parameters, residual.data(), jacobians));
    constexpr double kStep = 1e-6;
    for (int k = 0; k < 6; ++k) {
      Vector6d delta = Vector6d::Zero();
      delta[k] = kStep;
      PoseParameters plus, minus;
      manifold.Plus(x.data(), delta.data(), plus.data());
      delta[k] = -kStep;
      manifold.Plus(x.data(), delta.data(), minus.data());
      const Eigen::Vector2d numeric =
          (Residual(cost, plus, point) - Residual(cost, minus, point)) / (2 * kStep);
      EXPECT_NEAR((numeric - by_pose.col(k)).norm(), 0, 1e-4 * (1 + numeric.norm()));
    }
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
      const Eigen::Vector2d numeric =
          (Residual(cost, x, point + step) - Residual(cost, x, point - step)) / (2 * kStep);
      EXPECT_NEAR((numeric - by_point.col(k)).norm(), 0, 1e-4 * (1 + numeric.norm()));
    }
  }
}

TEST(PointCost, PointBehindTheCameraIsExpensiveButNoFailure) {
  const Camera camera = TestCamera();
  const PointCost cost(camera, {300, 200}, Eigen::Matrix2d::Identity());
  EXPECT_GT(Residual(cost, ToParameters(SE3()), {0, 0, -1}).norm(), 50);
}

TEST(Se3Manifold, MinusInvertsPlus) {
  const Se3Manifold manifold;
  const PoseParameters x = ToParameters(SE3(ExpSo3({0.3, -0.2, 1.0}), Eigen::Vector3d(1, 2, 3)));
  Vector6d delta;
  delta << 0.1, -0.2, 0.3, 0.2, 0.1, -0.3;
  PoseParameters y;
  manifold.Plus(x.data(), delta.data(), y.data());
  Vector6d back;
  manifold.Minus(y.data(), x.data(), back.data());
  EXPECT_NEAR((back - delta).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace vpslam
