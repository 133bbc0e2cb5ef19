#include "core/estimation/rotation_cost.h"

#include <array>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "core/estimation/se3_manifold.h"
#include "core/geometry/so3.h"

namespace vpslam {
namespace {

class RotationCostTest : public testing::Test {
 protected:
  Eigen::Vector3d Vector(double scale) {
    return scale * Eigen::Vector3d(uniform_(rng_), uniform_(rng_), uniform_(rng_));
  }
  static Eigen::Vector3d Residual(const RotationCost& cost, const PoseParameters& pose) {
    const double* parameters[] = {pose.data()};
    Eigen::Vector3d r;
    EXPECT_TRUE(cost.Evaluate(parameters, r.data(), nullptr));
    return r;
  }

  std::mt19937 rng_{1};
  std::uniform_real_distribution<double> uniform_{-1, 1};
};

TEST_F(RotationCostTest, IsTheMeasuredErrorInSigmas) {
  const SE3 pose(ExpSo3(Vector(2)), Vector(3));
  const Eigen::Quaterniond world_from_frame = ExpSo3(Vector(2));
  const Eigen::Vector3d error(0.01, -0.02, 0.005);
  const RotationCost cost(ExpSo3(error) * pose.rotation * world_from_frame, world_from_frame,
                          100 * Eigen::Matrix3d::Identity());
  EXPECT_NEAR((Residual(cost, ToParameters(pose)) - 100 * error).norm(), 0, 1e-9);
}

TEST_F(RotationCostTest, JacobianAgreesWithNumericOne) {
  const Se3Manifold manifold;
  for (int trial = 0; trial < 100; ++trial) {
    const SE3 pose(ExpSo3(Vector(2)), Vector(3));
    const Eigen::Quaterniond world_from_frame = ExpSo3(Vector(2));
    // From none at all, where the quotients of the series vanish, to a large error.
    const Eigen::Vector3d error = Vector(trial < 5 ? 0.0 : trial < 20 ? 1e-4 : 1.0);
    Eigen::Matrix3d weights;
    weights << 30, 1, 2, 0, 20, 3, 0, 0, 10;
    const RotationCost cost(ExpSo3(error) * pose.rotation * world_from_frame, world_from_frame,
                            weights);
    const PoseParameters x = ToParameters(pose);
    const double* parameters[] = {x.data()};
    Eigen::Vector3d residual;
    Eigen::Matrix<double, 3, 7, Eigen::RowMajor> by_pose;
    double* jacobians[] = {by_pose.data()};
    ASSERT_TRUE(cost.Evaluate(parameters, residual.data(), jacobians));
    constexpr double kStep = 1e-6;
    for (int k = 0; k < 6; ++k) {
      Vector6d delta = Vector6d::Zero();
      PoseParameters plus, minus;
      delta[k] = kStep;
      manifold.Plus(x.data(), delta.data(), plus.data());
      delta[k] = -kStep;
      manifold.Plus(x.data(), delta.data(), minus.data());
      const Eigen::Vector3d numeric = (Residual(cost, plus) - Residual(cost, minus)) / (2 * kStep);
      EXPECT_NEAR((numeric - by_pose.col(k)).norm(), 0, 1e-6 * (1 + numeric.norm())) << trial;
    }
  }
}

}  // namespace
}  // namespace vpslam
