// Similarity transforms, and the one that aligns two sets of points best.
//
// `b_from_a` maps x_b = s R x_a + t.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/geometry/se3.h"

namespace vpslam {

struct Sim3 {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  double scale = 1;  ///< > 0

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const {
    return scale * (rotation * x) + translation;
  }
  Sim3 operator*(const Sim3& other) const {
    return {(rotation * other.rotation).normalized(), *this * other.translation,
            scale * other.scale};
  }
  Sim3 Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {inverse, -(inverse * translation) / scale, 1 / scale};
  }
};

/// The pose of a camera after the world was transformed: `world` of the result is the b of
/// b_from_a, whose unit of length its translation has.
inline SE3 TransformWorld(const SE3& cam_from_a, const Sim3& b_from_a) {
  const Eigen::Quaterniond rotation = cam_from_a.rotation * b_from_a.rotation.conjugate();
  return SE3(rotation, -(rotation * (b_from_a * cam_from_a.Center())));
}

/// b_from_a with the least sum of squared distances |b_i - b_from_a a_i|^2 ([Ume91]); with
/// `with_scale` false the scale is 1. nullopt for fewer than 3 points, spans of unequal size, input
/// that is not finite, or points that lie on one line or in one place, where the rotation is
/// arbitrary.
std::optional<Sim3> AlignPoints(std::span<const Eigen::Vector3d> a,
                                std::span<const Eigen::Vector3d> b, bool with_scale = true);

}  // namespace vpslam
