// Whether what an image says of the Manhattan axes is worth taking.
#pragma once

#include <algorithm>

#include <Eigen/Eigenvalues>

#include "core/features/line_set.h"

namespace vpslam {

/// Largest standard deviation of a rotation about any axis, squared.
inline double WorstVariance(const Eigen::Matrix3d& covariance) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

/// Two axes or more with `min_support` distinct lines, and no direction more uncertain than that.
inline bool IsSoundManhattan(const LineSet& lines, int min_support, double max_sigma_rad) {
  if (lines.manhattan == ManhattanState::kNone || lines.vanishing_points.size() < 2) return false;
  const size_t num_axes = std::min<size_t>(3, lines.vanishing_points.size());
  int supported = 0;
  for (size_t i = 0; i < num_axes; ++i) {
    supported += lines.vanishing_points[i].support >= min_support;
  }
  return supported >= 2 && lines.covariance_rad2.allFinite() &&
         WorstVariance(lines.covariance_rad2) <= max_sigma_rad * max_sigma_rad;
}

}  // namespace vpslam
