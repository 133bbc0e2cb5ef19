#include "core/estimation/pose_optimizer.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "core/estimation/line_residual.h"
#include "core/estimation/point_residual.h"
#include "core/estimation/robust.h"

namespace vpslam {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

class Solver {
 public:
  Solver(const Camera& camera, const PoseMeasurements& measurements, PoseEstimate* estimate)
      : camera_(camera), m_(measurements), estimate_(*estimate) {}

  void Iterate(bool robust, int max_iterations) {
    for (int i = 0; i < max_iterations; ++i) {
      Linearise(robust);
      // A trace of damping keeps directions that nothing observes where they are.
      h_.diagonal().array() += 1e-9 * h_.diagonal().maxCoeff() + 1e-12;
      const Vector6d step = h_.ldlt().solve(b_);
      if (!step.allFinite()) break;
      estimate_.cam_from_world = Retract(estimate_.cam_from_world, step);
      if (step.squaredNorm() < 1e-14) break;
    }
  }

  void Classify() {
    const Eigen::Matrix3d r = estimate_.cam_from_world.RotationMatrix();
    const Eigen::Vector3d& t = estimate_.cam_from_world.translation;
    estimate_.num_inliers = estimate_.num_line_inliers = 0;
    for (size_t i = 0; i < m_.points.size(); ++i) {
      const PointMeasurement& m = m_.points[i];
      const Eigen::Vector3d x = r * m.point_in_world + t;
      const double s = x.z() < kMinDepth
                           ? kInfinity
                           : (m.sqrt_information * (camera_.Project(x) - m.px)).squaredNorm();
      estimate_.inliers[i] = s <= kChi2Dof2;
      estimate_.num_inliers += estimate_.inliers[i];
    }
    for (size_t i = 0; i < m_.lines.size(); ++i) {
      const LineMeasurement& m = m_.lines[i];
      const Eigen::Vector3d start = r * m.start_in_world + t, end = r * m.end_in_world + t;
      double s = kInfinity;
      if (start.z() >= kMinDepth || end.z() >= kMinDepth) {
        s = EvaluateLineResidual(camera_, start.cross(end), m.start_px, m.end_px, false)
                .value.squaredNorm() *
            m.inv_sigma2;
      }
      estimate_.line_inliers[i] = s <= kChi2Dof2;  // false for NaN
      estimate_.num_line_inliers += estimate_.line_inliers[i];
    }
  }

  void EstimateCovariance() {
    Linearise(false);
    h_.diagonal().array() += 1e-12;
    estimate_.covariance = h_.ldlt().solve(Matrix6d::Identity());
  }

 private:
  void Linearise(bool robust) {
    h_.setZero();
    b_.setZero();
    const Eigen::Matrix3d r = estimate_.cam_from_world.RotationMatrix();
    const Eigen::Vector3d& t = estimate_.cam_from_world.translation;
    for (size_t i = 0; i < m_.points.size(); ++i) {
      if (!estimate_.inliers[i]) continue;
      const PointMeasurement& m = m_.points[i];
      const Eigen::Vector3d x = r * m.point_in_world + t;
      if (x.z() < kMinDepth) continue;
      Add(m.sqrt_information * (camera_.Project(x) - m.px),
          PointResidualPoseJacobian(m.sqrt_information * ProjectionJacobian(camera_, x), x),
          robust);
    }
    for (size_t i = 0; i < m_.lines.size(); ++i) {
      if (!estimate_.line_inliers[i]) continue;
      const LineMeasurement& m = m_.lines[i];
      const Eigen::Vector3d start = r * m.start_in_world + t, end = r * m.end_in_world + t;
      if (start.z() < kMinDepth && end.z() < kMinDepth) continue;
      const Eigen::Vector3d direction = (end - start).normalized();
      const Eigen::Vector3d normal = start.cross(direction);
      const LineResidual residual =
          EvaluateLineResidual(camera_, normal, m.start_px, m.end_px, true);
      if (!residual.value.allFinite()) continue;
      const double inv_sigma_px = std::sqrt(m.inv_sigma2);
      Add(inv_sigma_px * residual.value,
          inv_sigma_px * residual.by_normal * LineNormalPoseJacobian(normal, direction), robust);
    }
    if (m_.rotation) AddRotation();
  }

  /// `e` and its Jacobian are in sigmas.
  void Add(const Eigen::Vector2d& e, const Eigen::Matrix<double, 2, 6>& j, bool robust) {
    const double w = robust ? HuberWeight(e.squaredNorm(), kChi2Dof2) : 1.0;
    h_.noalias() += w * j.transpose() * j;
    b_.noalias() -= w * j.transpose() * e;
  }

  void AddRotation() {
    const Eigen::Vector3d e =
        LogSo3(m_.rotation->cam_from_world * estimate_.cam_from_world.rotation.conjugate());
    const Eigen::Matrix3d& information = m_.rotation->information;
    const double s = e.dot(information * e);
    const Eigen::Matrix3d j = -InverseRightJacobianSo3(e);
    const double w = HuberWeight(s, kChi2Dof3);
    h_.bottomRightCorner<3, 3>() += w * j.transpose() * information * j;
    b_.tail<3>() -= w * j.transpose() * information * e;
  }

  const Camera& camera_;
  const PoseMeasurements& m_;
  PoseEstimate& estimate_;
  Matrix6d h_;
  Vector6d b_;
};

}  // namespace

PoseEstimate OptimizePose(const Camera& camera, const PoseMeasurements& measurements,
                          const SE3& initial, const PoseOptimizerOptions& options) {
  PoseEstimate estimate;
  estimate.cam_from_world = initial;
  const size_t num_points = measurements.points.size(), num_lines = measurements.lines.size();
  const bool enough = num_points + num_lines >= 3;
  estimate.inliers.assign(num_points, enough);
  estimate.line_inliers.assign(num_lines, enough);
  if (!enough) return estimate;
  Solver solver(camera, measurements, &estimate);
  for (int round = 0; round < options.rounds; ++round) {
    solver.Iterate(round < 2, options.iterations_per_round);
    solver.Classify();
  }
  if (estimate.num_inliers + estimate.num_line_inliers >= 3) solver.EstimateCovariance();
  return estimate;
}

}  // namespace vpslam
