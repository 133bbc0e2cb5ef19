#include "core/geometry/sim3.h"

#include <cmath>

#include <Eigen/SVD>

namespace vpslam {

std::optional<Sim3> AlignPoints(std::span<const Eigen::Vector3d> a,
                                std::span<const Eigen::Vector3d> b, bool with_scale) {
  if (a.size() != b.size() || a.size() < 3) return std::nullopt;
  const double n = static_cast<double>(a.size());
  Eigen::Vector3d mean_a = Eigen::Vector3d::Zero(), mean_b = Eigen::Vector3d::Zero();
  for (size_t i = 0; i < a.size(); ++i) {
    mean_a += a[i] / n;
    mean_b += b[i] / n;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // b by a
  double variance_a = 0, variance_b = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    const Eigen::Vector3d da = a[i] - mean_a, db = b[i] - mean_b;
    covariance += db * da.transpose() / n;
    variance_a += da.squaredNorm() / n;
    variance_b += db.squaredNorm() / n;
  }
  const double size = std::sqrt(variance_a * variance_b);
  if (!std::isfinite(size) || !covariance.allFinite()) return std::nullopt;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  // Two directions must be there; the third follows. Digits lost when the mean was subtracted
  // count as no extent.
  const double lost =
      1e-12 * (mean_a.norm() * std::sqrt(variance_b) + mean_b.norm() * std::sqrt(variance_a));
  if (!(svd.singularValues()[1] > 1e-9 * size + lost)) return std::nullopt;
  Eigen::Vector3d sign = Eigen::Vector3d::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) sign.z() = -1;
  Sim3 result;
  const Eigen::Matrix3d rotation = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
  result.rotation = Eigen::Quaterniond(rotation).normalized();
  if (with_scale) result.scale = svd.singularValues().dot(sign) / variance_a;
  if (!(result.scale > 0) || !std::isfinite(result.scale)) return std::nullopt;
  result.translation = mean_b - result.scale * (result.rotation * mean_a);
  return result;
}

}  // namespace vpslam
