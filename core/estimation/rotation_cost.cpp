#include "core/estimation/rotation_cost.h"

#include "core/geometry/so3.h"

namespace vpslam {

bool RotationCost::Evaluate(double const* const* parameters, double* residuals,
                            double** jacobians) const {
  const Eigen::Map<const Eigen::Quaterniond> cam_from_world(parameters[0]);
  const Eigen::Vector3d error =
      LogSo3(cam_from_frame_ * (cam_from_world * world_from_frame_).conjugate());
  Eigen::Map<Eigen::Vector3d> r(residuals);
  r = square_root_information_ * error;
  if (!jacobians || !jacobians[0]) return true;
  // Log(E Exp(-w)) = e - J_r^-1(e) w to first order.
  Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>> by_pose(jacobians[0]);
  by_pose.setZero();
  by_pose.middleCols<3>(3) = -square_root_information_ * InverseRightJacobianSo3(error);
  return true;
}

}  // namespace vpslam
