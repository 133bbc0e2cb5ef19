// Rigid transforms, and the conventions for them that hold everywhere.
//
// `b_from_a` maps coordinates in frame a to coordinates in frame b: x_b = R x_a + t, so that
// c_from_a = c_from_b * b_from_a. Frames: `world`, `cam` (x right, y down, z forward), `manhattan`.
// Poses are stored as cam_from_world; files hold world_from_cam, as the TUM format demands.
//
// Perturbation on the left with xi = (rho, phi): R' = Exp(phi) R, t' = Exp(phi) t + rho. To first
// order this is Exp(xi) T, so a point x in b moves by rho + phi x x.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/geometry/so3.h"

namespace vpslam {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

struct SE3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  SE3() = default;
  SE3(const Eigen::Quaterniond& q, const Eigen::Vector3d& t)
      : rotation(q.normalized()), translation(t) {}
  SE3(const Eigen::Matrix3d& r, const Eigen::Vector3d& t)
      : rotation(Eigen::Quaterniond(r).normalized()), translation(t) {}

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const { return rotation * x + translation; }
  SE3 operator*(const SE3& other) const {
    return SE3(rotation * other.rotation, rotation * other.translation + translation);
  }
  SE3 Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return SE3(inverse, -(inverse * translation));
  }
  /// The origin of frame b in coordinates of a: for cam_from_world, the camera centre in the world.
  Eigen::Vector3d Center() const { return -(rotation.conjugate() * translation); }
  Eigen::Matrix3d RotationMatrix() const { return rotation.toRotationMatrix(); }
};

/// T perturbed on the left by xi = (rho, phi), see the head of this file.
inline SE3 Retract(const SE3& pose, const Vector6d& xi) {
  const Eigen::Quaterniond d = ExpSo3(xi.tail<3>());
  return SE3(d * pose.rotation, d * pose.translation + xi.head<3>());
}

/// The xi with Retract(from, xi) == to.
inline Vector6d LocalCoordinates(const SE3& from, const SE3& to) {
  const Eigen::Quaterniond d = to.rotation * from.rotation.conjugate();
  Vector6d xi;
  xi.head<3>() = to.translation - d * from.translation;
  xi.tail<3>() = LogSo3(d);
  return xi;
}

}  // namespace vpslam
