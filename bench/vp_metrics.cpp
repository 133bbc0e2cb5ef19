#include "bench/vp_metrics.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "core/geometry/so3.h"
#include "core/geometry/sphere.h"

namespace vpslam {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

Eigen::Quaterniond NearestRotation(const Eigen::Matrix3d& m) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return Eigen::Quaterniond(svd.matrixU() * svd.matrixV().transpose());
}

}  // namespace

Eigen::Vector3d DirectionErrors_deg(const Eigen::Matrix3d& found, const Eigen::Matrix3d& truth) {
  std::array<int, 3> order{0, 1, 2};
  Eigen::Vector3d best = Eigen::Vector3d::Constant(1e9);
  do {
    Eigen::Vector3d errors;
    for (int k = 0; k < 3; ++k) {
      errors[k] = kDegrees * AxisAngle_rad(found.col(k), truth.col(order[static_cast<size_t>(k)]));
    }
    if (errors.sum() < best.sum()) best = errors;
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

double RotationError_deg(const Eigen::Matrix3d& found, const Eigen::Matrix3d& truth) {
  std::array<int, 3> order{0, 1, 2};
  const Eigen::Quaterniond q(found);
  double best = 180;
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d m;
      for (int k = 0; k < 3; ++k) {
        m.col(k) = (signs >> k & 1 ? -1.0 : 1.0) * truth.col(order[static_cast<size_t>(k)]);
      }
      if (m.determinant() < 0) continue;
      best = std::min(best, kDegrees * AngleBetween_rad(q, NearestRotation(m)));
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return best;
}

double Median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : 0.5 * (values[n / 2 - 1] + values[n / 2]);
}

void VpErrors::Add(const Eigen::Matrix3d& found, const Eigen::Matrix3d& truth) {
  const Eigen::Vector3d errors = DirectionErrors_deg(found, truth);
  for (int k = 0; k < 3; ++k) directions_deg_.push_back(errors[k]);
  rotations_deg_.push_back(RotationError_deg(found, truth));
}

double VpErrors::AA(double limit_deg) const {
  double sum = 0;
  for (const double e : directions_deg_) sum += std::max(0.0, 1 - e / limit_deg);
  return 100 * sum / static_cast<double>(directions_deg_.size());
}

double VpErrors::MeanCapped_deg() const {
  double sum = 0;
  for (const double e : directions_deg_) sum += std::min(e, 10.0);
  return sum / static_cast<double>(directions_deg_.size());
}

double VpErrors::ShareOver5_percent() const {
  const auto over =
      std::count_if(rotations_deg_.begin(), rotations_deg_.end(), [](double e) { return e > 5; });
  return 100.0 * static_cast<double>(over) / static_cast<double>(rotations_deg_.size());
}

}  // namespace vpslam
