#include "core/estimation/line_cost.h"

#include "core/estimation/line_residual.h"
#include "core/geometry/sphere.h"

namespace vpslam {

bool LineCost::Evaluate(double const* const* parameters, double* residuals,
                        double** jacobians) const {
  const Eigen::Map<const Eigen::Quaterniond> q(parameters[0]);
  const Eigen::Map<const Eigen::Vector3d> t(parameters[0] + 4);
  const Eigen::Map<const Eigen::Vector3d> point(parameters[1]);
  const Eigen::Map<const Eigen::Vector3d> direction(parameters[1] + 3);
  const Eigen::Matrix3d rotation = q.toRotationMatrix();
  const Eigen::Vector3d p = rotation * point + t;
  const Eigen::Vector3d d = rotation * direction;
  const Eigen::Vector3d n = p.cross(d);
  const LineResidual r = EvaluateLineResidual(camera_, n, start_px_, end_px_, jacobians != nullptr);
  Eigen::Map<Eigen::Vector2d> whitened(residuals);
  whitened = inv_sigma_px_ * r.value;
  if (!r.value.allFinite()) return false;  // the line runs through the camera's centre
  if (!jacobians) return true;
  const Eigen::Matrix<double, 2, 3> by_normal = inv_sigma_px_ * r.by_normal;
  if (jacobians[0]) {
    Eigen::Map<Eigen::Matrix<double, 2, 7, Eigen::RowMajor>> pose(jacobians[0]);
    pose.leftCols<6>() = by_normal * LineNormalPoseJacobian(n, d);
    pose.col(6).setZero();
  }
  if (jacobians[1]) {
    Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>> line(jacobians[1]);
    line.leftCols<3>() = -by_normal * Skew(d) * rotation;
    line.rightCols<3>() = by_normal * Skew(p) * rotation;
  }
  return true;
}

LineDirectionCost::LineDirectionCost(const Eigen::Vector3d& direction_in_world, double sigma_rad)
    : tangent_(TangentBasis(direction_in_world).transpose() / sigma_rad) {}

bool LineDirectionCost::Evaluate(double const* const* parameters, double* residuals,
                                 double** jacobians) const {
  const Eigen::Map<const Eigen::Vector3d> direction(parameters[0] + 3);
  Eigen::Map<Eigen::Vector2d> r(residuals);
  r = tangent_ * direction;
  if (!jacobians || !jacobians[0]) return true;
  Eigen::Map<Eigen::Matrix<double, 2, 6, Eigen::RowMajor>> line(jacobians[0]);
  line.leftCols<3>().setZero();
  line.rightCols<3>() = tangent_;
  return true;
}

}  // namespace vpslam
