// Huber's loss; the gates that go with it are in core/geometry/chi_square.h.
#pragma once

#include <cmath>

#include "core/geometry/chi_square.h"

namespace vpslam {

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
