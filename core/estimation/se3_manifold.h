// Poses as parameters of Ceres: seven numbers (qx, qy, qz, qw, tx, ty, tz), perturbed on the left
// by six (see core/geometry/se3.h).
//
// Cost functions of this project write their derivatives by the six perturbations into the first
// six of the seven columns that Ceres expects; the manifold's own Jacobian is then (I, 0)^T, so the
// product that Ceres forms is the derivative that was meant, at no cost.
#pragma once

#include <array>

#include <ceres/manifold.h>

#include "core/geometry/se3.h"

namespace vpslam {

using PoseParameters = std::array<double, 7>;

PoseParameters ToParameters(const SE3& pose);
SE3 FromParameters(const double* parameters);

class Se3Manifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

}  // namespace vpslam
