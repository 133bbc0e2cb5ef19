#include "core/estimation/se3_manifold.h"

namespace vpslam {

PoseParameters ToParameters(const SE3& pose) {
  const auto& q = pose.rotation;
  const auto& t = pose.translation;
  return {q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()};
}

SE3 FromParameters(const double* p) {
  return SE3(Eigen::Quaterniond(p[3], p[0], p[1], p[2]), Eigen::Vector3d(p[4], p[5], p[6]));
}

bool Se3Manifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const PoseParameters p =
      ToParameters(Retract(FromParameters(x), Eigen::Map<const Vector6d>(delta)));
  std::copy(p.begin(), p.end(), x_plus_delta);
  return true;
}

bool Se3Manifold::PlusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
  return true;
}

bool Se3Manifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Vector6d> result(y_minus_x);
  result = LocalCoordinates(FromParameters(x), FromParameters(y));
  return true;
}

bool Se3Manifold::MinusJacobian(const double*, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(jacobian).setIdentity();
  return true;
}

}  // namespace vpslam
