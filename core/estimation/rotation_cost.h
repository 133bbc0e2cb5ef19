// A measured rotation of the camera against a known frame as a Ceres cost, such as that of the
// Manhattan axes that vanishing points give: r = W Log(R_measured (R_cam_from_world
// R_world_from_frame)^T). Smooth and free of the axes' signs, unlike the paper's eq. 5.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <ceres/sized_cost_function.h>

namespace vpslam {

/// Parameter: the pose cam_from_world, see core/estimation/se3_manifold.h. Residual in sigmas.
class RotationCost final : public ceres::SizedCostFunction<3, 7> {
 public:
  /// `square_root_information`: W with W^T W the inverse covariance (1 / rad^2) of the measured
  /// rotation's left perturbation.
  RotationCost(const Eigen::Quaterniond& cam_from_frame, const Eigen::Quaterniond& world_from_frame,
               const Eigen::Matrix3d& square_root_information)
      : cam_from_frame_(cam_from_frame),
        world_from_frame_(world_from_frame),
        square_root_information_(square_root_information) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Quaterniond cam_from_frame_;
  Eigen::Quaterniond world_from_frame_;
  Eigen::Matrix3d square_root_information_;
};

}  // namespace vpslam
