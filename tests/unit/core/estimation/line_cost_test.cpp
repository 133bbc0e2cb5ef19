#include "core/estimation/line_cost.h"

#include <deque>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <ceres/line_manifold.h>
#include <gtest/gtest.h>

#include "core/estimation/line_residual.h"
#include "core/estimation/se3_manifold.h"
#include "core/geometry/sphere.h"
#include "tests/unit/test_camera.h"

namespace vpslam {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

class LineCostTest : public testing::Test {
 protected:
  Eigen::Vector3d Vector(double scale = 1) {
    const double x = uniform_(rng_), y = uniform_(rng_), z = uniform_(rng_);
    return scale * Eigen::Vector3d(x, y, z);
  }
  SE3 Pose() {
    const Eigen::Quaterniond rotation = ExpSo3(Vector());
    return SE3(rotation, Vector());
  }
  /// A line about 3 before the camera, 0.5 to 3 long.
  LineParameters LineBefore(const SE3& cam_from_world) {
    const SE3 world_from_cam = cam_from_world.Inverse();
    const Eigen::Vector3d start = Vector() + Eigen::Vector3d(0, 0, 3);
    const Eigen::Vector3d along = Vector();
    return ToLineParameters(world_from_cam * start,
                            world_from_cam * (start + along + 0.5 * along.normalized()));
  }
  static Eigen::Vector2d Residual(const ceres::CostFunction& cost, const double* a,
                                  const double* b = nullptr) {
    const double* parameters[] = {a, b};
    Eigen::Vector2d residual;
    EXPECT_TRUE(cost.Evaluate(parameters, residual.data(), nullptr));
    return residual;
  }
  static void ExpectClose(const Eigen::Vector2d& numeric, const Eigen::Vector2d& analytic) {
    EXPECT_NEAR((numeric - analytic).norm(), 0, 1e-5 * (1 + numeric.norm()));
  }

  const Camera camera_ = TestCamera();
  const ceres::LineManifold<3> manifold_;
  std::mt19937 rng_{1};
  std::uniform_real_distribution<double> uniform_{-1, 1};
  static constexpr double kStep = 1e-6;
};

TEST_F(LineCostTest, IsTheDistanceOfTheEndsInSigmas) {
  // v = 240 + 480 / 4 = 360 is its image.
  const LineParameters line = ToLineParameters({-1, 1, 4}, {2, 1, 4});
  const PoseParameters pose = ToParameters(SE3());
  const LineCost cost(camera_, {100, 363}, {400, 356}, 2.0);
  Eigen::Vector2d r = Residual(cost, pose.data(), line.data());
  if (r[0] < 0) r = -r;
  EXPECT_NEAR(r[0], 6, 1e-9);
  EXPECT_NEAR(r[1], -8, 1e-9) << "the other side";
}

TEST_F(LineCostTest, EndsMeasureNothingAlongTheLine) {
  for (int trial = 0; trial < 50; ++trial) {
    const SE3 pose = Pose();
    const PoseParameters x = ToParameters(pose);
    LineParameters line = LineBefore(pose);
    const LineCost cost(camera_, {300, 200}, {200, 250}, 1.0);
    const Eigen::Vector2d before = Residual(cost, x.data(), line.data());
    // The point may be anywhere on the line, and the direction of any length.
    for (int i = 0; i < 3; ++i) line[i] += 0.7 * line[i + 3];
    for (int i = 3; i < 6; ++i) line[i] *= 1.3;
    EXPECT_NEAR((Residual(cost, x.data(), line.data()) - before).norm(), 0, 1e-8 * before.norm());
    for (int i = 3; i < 6; ++i) line[i] *= -1;
    EXPECT_NEAR((Residual(cost, x.data(), line.data()) + before).norm(), 0, 1e-8 * before.norm());
  }
}

TEST_F(LineCostTest, JacobiansAgreeWithNumericOnes) {
  const Se3Manifold poses;
  for (int trial = 0; trial < 200; ++trial) {
    const SE3 pose = Pose();
    const LineParameters line = LineBefore(pose);
    const PoseParameters x = ToParameters(pose);
    const LineCost cost(camera_, {300 + 90 * uniform_(rng_), 200}, {350, 260}, 0.7);
    const double* parameters[] = {x.data(), line.data()};
    Eigen::Vector2d residual;
    Eigen::Matrix<double, 2, 7, Eigen::RowMajor> by_pose;
    Eigen::Matrix<double, 2, 6, Eigen::RowMajor> by_line;
    double* jacobians[] = {by_pose.data(), by_line.data()};
    ASSERT_TRUE(cost.Evaluate(parameters, residual.data(), jacobians));
    EXPECT_EQ(residual, Residual(cost, x.data(), line.data()));
    for (int k = 0; k < 6; ++k) {
      Vector6 delta = kStep * Vector6::Unit(k);
      PoseParameters plus, minus;
      poses.Plus(x.data(), delta.data(), plus.data());
      delta = -delta;
      poses.Plus(x.data(), delta.data(), minus.data());
      ExpectClose(
          (Residual(cost, plus.data(), line.data()) - Residual(cost, minus.data(), line.data())) /
              (2 * kStep),
          by_pose.col(k));
    }
    EXPECT_EQ(by_pose.col(6).norm(), 0);
    for (int k = 0; k < 6; ++k) {
      LineParameters plus = line, minus = line;
      plus[k] += kStep;
      minus[k] -= kStep;
      ExpectClose((Residual(cost, x.data(), plus.data()) - Residual(cost, x.data(), minus.data())) /
                      (2 * kStep),
                  by_line.col(k));
    }
    // And by the four that the manifold leaves.
    Eigen::Matrix<double, 6, 4, Eigen::RowMajor> plus_jacobian;
    ASSERT_TRUE(manifold_.PlusJacobian(line.data(), plus_jacobian.data()));
    const Eigen::Matrix<double, 2, 4> by_tangent = by_line * plus_jacobian;
    for (int k = 0; k < 4; ++k) {
      Eigen::Vector4d delta = kStep * Eigen::Vector4d::Unit(k);
      LineParameters plus, minus;
      manifold_.Plus(line.data(), delta.data(), plus.data());
      delta = -delta;
      manifold_.Plus(line.data(), delta.data(), minus.data());
      ExpectClose((Residual(cost, x.data(), plus.data()) - Residual(cost, x.data(), minus.data())) /
                      (2 * kStep),
                  by_tangent.col(k));
    }
  }
}

TEST_F(LineCostTest, ALineThroughTheCameraIsAFailureNotANumber) {
  const PoseParameters pose = ToParameters(SE3());
  const LineParameters line = ToLineParameters({0, 0, 1}, {0, 0, 3});
  const LineCost cost(camera_, {300, 200}, {350, 260}, 1);
  const double* parameters[] = {pose.data(), line.data()};
  Eigen::Vector2d residual;
  EXPECT_FALSE(cost.Evaluate(parameters, residual.data(), nullptr));
}

TEST_F(LineCostTest, LeastSquaresErrorsAgreeWithTheCovariance) {
  // One line from five known views; its four parameters by Gauss-Newton from nearby.
  std::normal_distribution<double> normal(0, 0.8);
  double sum = 0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::Vector3d start(-1 + 0.3 * uniform_(rng_), 0.5 * uniform_(rng_), 4);
    const Eigen::Vector3d end = start + Eigen::Vector3d(2, 0.6 * uniform_(rng_), uniform_(rng_));
    const LineParameters truth = ToLineParameters(start, end);
    std::deque<LineCost> costs;
    std::vector<PoseParameters> poses;
    for (int view = 0; view < 5; ++view) {
      const SE3 pose(ExpSo3(Vector(0.1)), Eigen::Vector3d(0.2 * view, 0.3 * view, 0));
      const auto px = [&](const Eigen::Vector3d& x) -> Eigen::Vector2d {
        const double dx = normal(rng_), dy = normal(rng_);
        return camera_.Project(pose * x) + Eigen::Vector2d(dx, dy);
      };
      const Eigen::Vector2d a = px(start), b = px(end);
      costs.emplace_back(camera_, a, b, 1 / 0.8);
      poses.push_back(ToParameters(pose));
    }
    LineParameters line;
    const Eigen::Vector4d off(0.02, -0.01, 0.02, 0.03);
    manifold_.Plus(truth.data(), off.data(), line.data());
    Eigen::Matrix4d h;
    for (int iteration = 0; iteration < 8; ++iteration) {
      h.setZero();
      Eigen::Vector4d g = Eigen::Vector4d::Zero();
      Eigen::Matrix<double, 6, 4, Eigen::RowMajor> plus_jacobian;
      manifold_.PlusJacobian(line.data(), plus_jacobian.data());
      for (size_t i = 0; i < costs.size(); ++i) {
        const double* parameters[] = {poses[i].data(), line.data()};
        Eigen::Vector2d r;
        Eigen::Matrix<double, 2, 6, Eigen::RowMajor> by_line;
        double* jacobians[] = {nullptr, by_line.data()};
        ASSERT_TRUE(costs[i].Evaluate(parameters, r.data(), jacobians));
        const Eigen::Matrix<double, 2, 4> j = by_line * plus_jacobian;
        h += j.transpose() * j;
        g += j.transpose() * r;
      }
      const Eigen::Vector4d step = h.ldlt().solve(-g);
      LineParameters next;
      manifold_.Plus(line.data(), step.data(), next.data());
      line = next;
    }
    Eigen::Vector4d error;
    manifold_.Minus(truth.data(), line.data(), error.data());
    sum += error.dot(h * error);
  }
  // Chi-square with four degrees of freedom: the mean of 300 has a standard deviation of 0.16.
  EXPECT_NEAR(sum / kTrials, 4, 0.6);
}

TEST_F(LineCostTest, TheManifoldGoesThereAndBack) {
  for (int trial = 0; trial < 200; ++trial) {
    const LineParameters x = LineBefore(Pose());
    const Eigen::Vector3d a = Vector(0.5), b = Vector(0.5);
    const Eigen::Vector4d delta(a.x(), a.y(), a.z(), b.x());
    LineParameters y;
    manifold_.Plus(x.data(), delta.data(), y.data());
    Eigen::Vector4d back;
    manifold_.Minus(y.data(), x.data(), back.data());
    EXPECT_NEAR((back - delta).norm(), 0, 1e-9);
    const Eigen::Map<const Eigen::Vector3d> direction(y.data() + 3);
    EXPECT_NEAR(direction.norm(), 1, 1e-12);
    // Where on the line its point lies is no part of it.
    LineParameters slid = x;
    for (int i = 0; i < 3; ++i) slid[i] += 0.4 * x[i + 3];
    manifold_.Minus(slid.data(), x.data(), back.data());
    EXPECT_NEAR(back.norm(), 0, 1e-9);
  }
}

TEST_F(LineCostTest, ParametersAreThoseOfTheLineThroughTheEnds) {
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Vector3d start = Vector(), end = Vector();
    const LineParameters line = ToLineParameters(start, end);
    const Eigen::Map<const Eigen::Vector3d> p(line.data()), d(line.data() + 3);
    EXPECT_NEAR(d.norm(), 1, 1e-12);
    EXPECT_GT(d.dot(end - start), 0) << "it runs from start to end";
    const double half = 0.5 * (end - start).norm();
    EXPECT_NEAR((p - half * d - start).norm(), 0, 1e-12);
    EXPECT_NEAR((p + half * d - end).norm(), 0, 1e-12);
  }
}

TEST_F(LineCostTest, DirectionIsTheAngleInSigmasWhateverItsSign) {
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d axis = Vector().normalized();
    const Eigen::Matrix<double, 3, 2> tangent = TangentBasis(axis);
    const Eigen::Vector2d off(0.02, -0.01);
    const LineDirectionCost cost(axis, 0.005);
    for (const double sign : {1.0, -1.0}) {
      const Eigen::Vector3d d = sign * (axis + tangent * off).normalized();
      LineParameters line{1, 2, 3, d.x(), d.y(), d.z()};
      EXPECT_NEAR(Residual(cost, line.data()).norm(), std::sin(AxisAngle_rad(axis, d)) / 0.005,
                  1e-9);
      line = {1, 2, 3, sign * axis.x(), sign * axis.y(), sign * axis.z()};
      EXPECT_NEAR(Residual(cost, line.data()).norm(), 0, 1e-12);
    }
  }
}

TEST_F(LineCostTest, DirectionsJacobianAgreesWithTheNumericOne) {
  for (int trial = 0; trial < 100; ++trial) {
    const LineDirectionCost cost(Vector().normalized(), 0.01);
    const LineParameters line = LineBefore(Pose());
    const double* parameters[] = {line.data()};
    Eigen::Vector2d residual;
    Eigen::Matrix<double, 2, 6, Eigen::RowMajor> by_line;
    double* jacobians[] = {by_line.data()};
    ASSERT_TRUE(cost.Evaluate(parameters, residual.data(), jacobians));
    Eigen::Matrix<double, 6, 4, Eigen::RowMajor> plus_jacobian;
    manifold_.PlusJacobian(line.data(), plus_jacobian.data());
    const Eigen::Matrix<double, 2, 4> by_tangent = by_line * plus_jacobian;
    for (int k = 0; k < 4; ++k) {
      Eigen::Vector4d delta = kStep * Eigen::Vector4d::Unit(k);
      LineParameters plus, minus;
      manifold_.Plus(line.data(), delta.data(), plus.data());
      delta = -delta;
      manifold_.Plus(line.data(), delta.data(), minus.data());
      ExpectClose((Residual(cost, plus.data()) - Residual(cost, minus.data())) / (2 * kStep),
                  by_tangent.col(k));
    }
  }
}

TEST(LineNormalPoseJacobian, AgreesWithTheNumericOne) {
  const Eigen::Vector3d p(0.3, -0.2, 2), d = Eigen::Vector3d(1, 2, -0.5).normalized();
  const Eigen::Matrix<double, 3, 6> j = LineNormalPoseJacobian(p.cross(d), d);
  constexpr double kStep = 1e-6;
  for (int k = 0; k < 6; ++k) {
    const auto normal = [&](double step) -> Eigen::Vector3d {
      const SE3 moved = Retract(SE3(), step * Vector6d::Unit(k));
      return (moved * p).cross(moved.rotation * d);
    };
    EXPECT_NEAR(((normal(kStep) - normal(-kStep)) / (2 * kStep) - j.col(k)).norm(), 0, 1e-8);
  }
}

TEST(LineSigma, IsNeverLessThanWhatEdgesAllow) {
  EXPECT_GT(LineSigma_px(0), 0.3);
  EXPECT_GT(LineSigma_px(1), LineSigma_px(0.5));
  EXPECT_NEAR(LineSigma_px(100) / 100, 1, 0.01);
}

}  // namespace
}  // namespace vpslam
