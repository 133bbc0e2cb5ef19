// Huber's loss and the chi-square gates that go with it.
#pragma once

#include <cmath>

namespace vpslam {

/// 95 % quantiles of chi2 with one, two and three degrees of freedom: a gate on squared, whitened
/// residuals which one good measurement in twenty fails.
inline constexpr double kChi2Dof1 = 3.841;
inline constexpr double kChi2Dof2 = 5.991;
inline constexpr double kChi2Dof3 = 7.815;

/// Weight w(s) of iteratively re-weighted least squares for the squared, whitened residual s:
/// quadratic below delta2 = delta^2, linear beyond.
inline double HuberWeight(double s, double delta2) {
  return s <= delta2 ? 1.0 : std::sqrt(delta2 / s);
}

/// Huber's rho(s), with rho(s) = s below delta2.
inline double HuberCost(double s, double delta2) {
  return s <= delta2 ? s : 2.0 * std::sqrt(delta2 * s) - delta2;
}

}  // namespace vpslam
