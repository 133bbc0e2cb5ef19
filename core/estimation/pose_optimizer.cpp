#include "core/estimation/pose_optimizer.h"

#include <Eigen/Cholesky>

#include "core/estimation/point_residual.h"
#include "core/estimation/robust.h"

namespace vpslam {
namespace {

struct NormalEquations {
  Matrix6d h = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
  double cost = 0;
};

/// Squared, whitened error; infinite behind the camera.
double Chi2(const Camera& camera, const PointMeasurement& m, const Eigen::Matrix3d& r,
            const Eigen::Vector3d& t) {
  const Eigen::Vector3d x = r * m.point_in_world + t;
  if (x.z() < kMinDepth) return std::numeric_limits<double>::infinity();
  return (camera.Project(x) - m.px).squaredNorm() * m.inv_sigma2;
}

NormalEquations Linearise(const Camera& camera, std::span<const PointMeasurement> points,
                          const std::vector<uint8_t>& inliers, const SE3& pose, bool robust) {
  NormalEquations n;
  const Eigen::Matrix3d r = pose.RotationMatrix();
  for (size_t i = 0; i < points.size(); ++i) {
    if (!inliers[i]) continue;
    const PointMeasurement& m = points[i];
    const Eigen::Vector3d x = r * m.point_in_world + pose.translation;
    if (x.z() < kMinDepth) continue;
    const Eigen::Vector2d e = camera.Project(x) - m.px;
    const double s = e.squaredNorm() * m.inv_sigma2;
    const double w = m.inv_sigma2 * (robust ? HuberWeight(s, kChi2Dof2) : 1.0);
    n.cost += robust ? HuberCost(s, kChi2Dof2) : s;
    const Eigen::Matrix<double, 2, 6> j =
        PointResidualPoseJacobian(ProjectionJacobian(camera, x), x);
    n.h.noalias() += w * j.transpose() * j;
    n.b.noalias() -= w * j.transpose() * e;
  }
  return n;
}

int Classify(const Camera& camera, std::span<const PointMeasurement> points, const SE3& pose,
             std::vector<uint8_t>* inliers) {
  const Eigen::Matrix3d r = pose.RotationMatrix();
  int count = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    (*inliers)[i] = Chi2(camera, points[i], r, pose.translation) <= kChi2Dof2;
    count += (*inliers)[i];
  }
  return count;
}

}  // namespace

PoseEstimate OptimizePose(const Camera& camera, std::span<const PointMeasurement> points,
                          const SE3& initial, const PoseOptimizerOptions& options) {
  PoseEstimate estimate;
  estimate.cam_from_world = initial;
  estimate.inliers.assign(points.size(), 1);
  estimate.num_inliers = 0;
  if (points.size() < 3) {
    estimate.inliers.assign(points.size(), 0);
    return estimate;
  }
  SE3 pose = initial;
  for (int round = 0; round < options.rounds; ++round) {
    const bool robust = round < 2;
    for (int i = 0; i < options.iterations_per_round; ++i) {
      NormalEquations n = Linearise(camera, points, estimate.inliers, pose, robust);
      // A trace of damping keeps directions that nothing observes where they are.
      n.h.diagonal().array() += 1e-9 * n.h.diagonal().maxCoeff() + 1e-12;
      const Vector6d step = n.h.ldlt().solve(n.b);
      if (!step.allFinite()) break;
      pose = Retract(pose, step);
      if (step.squaredNorm() < 1e-14) break;
    }
    estimate.num_inliers = Classify(camera, points, pose, &estimate.inliers);
  }
  estimate.cam_from_world = pose;
  if (estimate.num_inliers >= 3) {
    NormalEquations n = Linearise(camera, points, estimate.inliers, pose, false);
    n.h.diagonal().array() += 1e-12;
    estimate.covariance = n.h.ldlt().solve(Matrix6d::Identity());
  }
  return estimate;
}

}  // namespace vpslam
