// Directions as points of the unit sphere: the tangent plane in which their covariances are given.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace vpslam {

/// Two unit vectors, as columns, that make with `direction` (unit) a right-handed orthonormal frame
/// (b0, b1, direction). A small change of the direction is B t, with t in radians. The same
/// direction always gives the same basis, so that a 2 x 2 covariance can travel without it.
inline Eigen::Matrix<double, 3, 2> TangentBasis(const Eigen::Vector3d& direction) {
  // The axis that the direction is farthest from, so that the cross product is well conditioned.
  Eigen::Index smallest = 0;
  direction.cwiseAbs().minCoeff(&smallest);
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = direction.cross(Eigen::Vector3d::Unit(smallest)).normalized();
  basis.col(1) = direction.cross(basis.col(0));
  return basis;
}

/// Angle between two undirected axes (unit vectors), in [0, pi/2].
inline double AxisAngle_rad(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), std::abs(a.dot(b)));
}

}  // namespace vpslam
