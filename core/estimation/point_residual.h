// Reprojection error of a point: r = pi(R X + t) - x, in px (paper sec. III-C, E_p).
#pragma once

#include <Eigen/Core>

#include "core/geometry/camera.h"
#include "core/geometry/se3.h"

namespace vpslam {

/// Points closer than this (in map units, where the first map's median depth is 1) or behind the
/// camera have no meaningful projection.
inline constexpr double kMinDepth = 1e-3;

/// d pi / d x_cam, for x_cam.z() > 0. 2 x 3, px per map unit.
inline Eigen::Matrix<double, 2, 3> ProjectionJacobian(const Camera& camera,
                                                      const Eigen::Vector3d& x_cam) {
  const double inv_z = 1.0 / x_cam.z();
  Eigen::Matrix<double, 2, 3> j;
  j << camera.fx * inv_z, 0, -camera.fx * x_cam.x() * inv_z * inv_z,  //
      0, camera.fy * inv_z, -camera.fy * x_cam.y() * inv_z * inv_z;
  return j;
}

/// d r / d xi for the left perturbation xi = (rho, phi) of cam_from_world: a point in the camera
/// moves by rho + phi x x_cam.
inline Eigen::Matrix<double, 2, 6> PointResidualPoseJacobian(
    const Eigen::Matrix<double, 2, 3>& projection_jacobian, const Eigen::Vector3d& x_cam) {
  Eigen::Matrix<double, 2, 6> j;
  j.leftCols<3>() = projection_jacobian;
  j.rightCols<3>() = -projection_jacobian * Skew(x_cam);
  return j;
}

}  // namespace vpslam
