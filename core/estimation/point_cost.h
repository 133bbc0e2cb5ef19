// The reprojection error of a point as a Ceres cost: parameters are the pose cam_from_world
// (core/estimation/se3_manifold.h) and the point in world; the residual is whitened, in sigmas.
#pragma once

#include <ceres/sized_cost_function.h>

#include "core/geometry/camera.h"

namespace vpslam {

class PointCost final : public ceres::SizedCostFunction<2, 7, 3> {
 public:
  /// `camera` must outlive this. `sqrt_information`: symmetric, 1 / px.
  PointCost(const Camera& camera, const Eigen::Vector2d& px,
            const Eigen::Matrix2d& sqrt_information)
      : camera_(camera), px_(px), sqrt_information_(sqrt_information) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  const Camera& camera_;
  Eigen::Vector2d px_;
  Eigen::Matrix2d sqrt_information_;
};

}  // namespace vpslam
