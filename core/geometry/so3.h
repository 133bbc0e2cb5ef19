// Rotations: the exponential map of SO(3) and its inverse.
//
// Perturbation convention of the whole project: on the left, R' = Exp(w) R.
#pragma once

#include <cmath>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace vpslam {

/// [v]_x, the matrix with [v]_x w = v x w.
inline Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Rotation by |w| radians about w.
inline Eigen::Quaterniond ExpSo3(const Eigen::Vector3d& w_rad) {
  const double theta = w_rad.norm();
  // sin(theta/2)/theta by its series near 0, where the quotient loses digits.
  const double s = theta < 1e-6 ? 0.5 - theta * theta / 48.0 : std::sin(0.5 * theta) / theta;
  const double c = std::cos(0.5 * theta);
  return Eigen::Quaterniond(c, s * w_rad.x(), s * w_rad.y(), s * w_rad.z()).normalized();
}

/// Inverse of ExpSo3, with |w| in [0, pi].
inline Eigen::Vector3d LogSo3(const Eigen::Quaterniond& q) {
  const double sign = q.w() < 0 ? -1.0 : 1.0;
  const Eigen::Vector3d v = sign * q.vec();
  const double n = v.norm();
  // atan2 keeps its accuracy at both ends, acos does not.
  const double scale = n < 1e-9 ? 2.0 : 2.0 * std::atan2(n, sign * q.w()) / n;
  return scale * v;
}

/// J with Log(Exp(w) Exp(d)) = w + J d + O(d^2).
inline Eigen::Matrix3d InverseRightJacobianSo3(const Eigen::Vector3d& w_rad) {
  const double theta2 = w_rad.squaredNorm();
  const double theta = std::sqrt(theta2);
  // (1/theta^2 - (1 + cos) / (2 theta sin)), by its series near 0.
  const double c = theta < 1e-3
                       ? 1.0 / 12.0 + theta2 / 720.0
                       : 1.0 / theta2 - (1.0 + std::cos(theta)) / (2.0 * theta * std::sin(theta));
  const Eigen::Matrix3d skew = Skew(w_rad);
  return Eigen::Matrix3d::Identity() + 0.5 * skew + c * skew * skew;
}

/// Angle of the rotation that takes a to b, in [0, pi].
inline double AngleBetween_rad(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return LogSo3(b * a.conjugate()).norm();
}

}  // namespace vpslam
