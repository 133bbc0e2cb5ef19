#include "core/estimation/point_cost.h"

#include "core/estimation/point_residual.h"
#include "core/estimation/se3_manifold.h"

namespace vpslam {
namespace {

// What a point behind the camera costs, in sigmas: more than any step that leaves it in front.
// Refusing the evaluation instead would let one such point reject every step of all others.
constexpr double kBehindCameraSigmas = 100.0;

}  // namespace

bool PointCost::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  const Eigen::Map<const Eigen::Quaterniond> q(parameters[0]);
  const Eigen::Map<const Eigen::Vector3d> t(parameters[0] + 4);
  const Eigen::Map<const Eigen::Vector3d> point(parameters[1]);
  Eigen::Map<Eigen::Vector2d> r(residuals);
  const Eigen::Matrix3d rotation = q.toRotationMatrix();
  const Eigen::Vector3d x = rotation * point + t;
  const bool in_front = x.z() >= kMinDepth;
  if (in_front) {
    r = sqrt_information_ * (camera_.Project(x) - px_);
  } else {
    r.setConstant(kBehindCameraSigmas);
  }
  if (!jacobians) return true;
  Eigen::Matrix<double, 2, 3> j = Eigen::Matrix<double, 2, 3>::Zero();
  if (in_front) j = sqrt_information_ * ProjectionJacobian(camera_, x);
  if (jacobians[0]) {
    Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> pose(jacobians[0]);
    pose.leftCols<6>() = PointResidualPoseJacobian(j, x);
    pose.col(6).setZero();
  }
  if (jacobians[1]) {
    Eigen::Map<Eigen::Matrix<double, 2, 3, Eigen::RowMajor>> by_point(jacobians[1]);
    by_point = j * rotation;
  }
  return true;
}

}  // namespace vpslam
