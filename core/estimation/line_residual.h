// Distance of a segment's end points from the image of a 3D line, in px (paper sec. III-C, E_l).
//
// The plane through the camera's centre and the line has the normal n = p x d, with p a point of
// the line and d its direction, in camera coordinates. Its image is l = K^-T n. The residual is the
// signed distance of each end point, (l . x) / |(l_0, l_1)|: what a detector says along the line is
// no measurement, for ends are where it lost the edge. It does not depend on the length of n.
#pragma once

#include <cmath>

#include <Eigen/Core>

#include "core/geometry/camera.h"
#include "core/geometry/se3.h"
#include "core/geometry/so3.h"

namespace vpslam {

/// What a segment's end points err across the line. What the detector promises is how well the edge
/// is measured; on top of it comes that edges have a width and are rounded, that lenses bend, and
/// that the same edge is not the same in every light.
inline double LineSigma_px(double detector_sigma_px) {
  constexpr double kModelSigma_px = 0.7;
  return std::hypot(detector_sigma_px, kModelSigma_px);
}

struct LineResidual {
  Eigen::Vector2d value = Eigen::Vector2d::Zero();                              ///< start, end; px
  Eigen::Matrix<double, 2, 3> by_normal = Eigen::Matrix<double, 2, 3>::Zero();  ///< d value / d n
};

/// K^-T n: a u + b v + c = 0 in undistorted px.
inline Eigen::Vector3d ImageLine(const Camera& camera, const Eigen::Vector3d& normal_in_cam) {
  const double a = normal_in_cam.x() / camera.fx;
  const double b = normal_in_cam.y() / camera.fy;
  return {a, b, normal_in_cam.z() - camera.cx * a - camera.cy * b};
}

/// `normal_in_cam` must not be along the optical axis: that plane has no image line.
inline LineResidual EvaluateLineResidual(const Camera& camera, const Eigen::Vector3d& normal_in_cam,
                                         const Eigen::Vector2d& start_px,
                                         const Eigen::Vector2d& end_px, bool with_jacobian) {
  const Eigen::Vector3d line = ImageLine(camera, normal_in_cam);
  const double inv_norm = 1.0 / std::hypot(line.x(), line.y());
  LineResidual r;
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector2d& x = i == 0 ? start_px : end_px;
    const double e = (line.x() * x.x() + line.y() * x.y() + line.z()) * inv_norm;
    r.value[i] = e;
    if (!with_jacobian) continue;
    const Eigen::Vector3d by_line(x.x() * inv_norm - e * line.x() * inv_norm * inv_norm,
                                  x.y() * inv_norm - e * line.y() * inv_norm * inv_norm, inv_norm);
    r.by_normal(i, 0) = (by_line.x() - camera.cx * by_line.z()) / camera.fx;
    r.by_normal(i, 1) = (by_line.y() - camera.cy * by_line.z()) / camera.fy;
    r.by_normal(i, 2) = by_line.z();
  }
  return r;
}

/// d n / d xi for the left perturbation xi = (rho, phi) of cam_from_world, with n = p x d:
/// rho x d + phi x n.
inline Eigen::Matrix<double, 3, 6> LineNormalPoseJacobian(const Eigen::Vector3d& normal_in_cam,
                                                          const Eigen::Vector3d& direction_in_cam) {
  Eigen::Matrix<double, 3, 6> j;
  j.leftCols<3>() = -Skew(direction_in_cam);
  j.rightCols<3>() = -Skew(normal_in_cam);
  return j;
}

}  // namespace vpslam
