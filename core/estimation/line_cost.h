// Costs of a line in bundle adjustment: its reprojection error, and its distance from a direction
// that vanishing points give it.
//
// A line has four degrees of freedom; its parameters are six, a point and a unit direction, on
// ceres::LineManifold<3>.
#pragma once

#include <array>

#include <Eigen/Core>
#include <ceres/sized_cost_function.h>

#include "core/geometry/camera.h"

namespace vpslam {

using LineParameters = std::array<double, 6>;  ///< point of the line, unit direction; in world

inline LineParameters ToLineParameters(const Eigen::Vector3d& start, const Eigen::Vector3d& end) {
  const Eigen::Vector3d point = 0.5 * (start + end);
  const Eigen::Vector3d direction = (end - start).normalized();
  return {point.x(),     point.y(),     point.z(),  //
          direction.x(), direction.y(), direction.z()};
}

/// Parameters: the pose cam_from_world (core/estimation/se3_manifold.h) and the line. The residual
/// is that of core/estimation/line_residual.h, in sigmas.
class LineCost final : public ceres::SizedCostFunction<2, 7, 6> {
 public:
  /// `camera` must outlive this.
  LineCost(const Camera& camera, const Eigen::Vector2d& start_px, const Eigen::Vector2d& end_px,
           double inv_sigma_px)
      : camera_(camera), start_px_(start_px), end_px_(end_px), inv_sigma_px_(inv_sigma_px) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const Camera& camera_;
  Eigen::Vector2d start_px_, end_px_;
  double inv_sigma_px_;
};

/// Holds a line to a direction of the world, whose sign carries no meaning: r = B^T d / sigma, with
/// B the tangent plane at the direction.
class LineDirectionCost final : public ceres::SizedCostFunction<2, 6> {
 public:
  LineDirectionCost(const Eigen::Vector3d& direction_in_world, double sigma_rad);

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Matrix<double, 2, 3> tangent_;  ///< in sigmas
};

}  // namespace vpslam
