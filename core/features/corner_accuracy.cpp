#include "core/features/corner_accuracy.h"

#include <algorithm>
#include <cmath>

namespace vpslam {

Eigen::Matrix2d CornerSqrtInformation(const Keypoint& keypoint, const ScalePyramid& scales) {
  constexpr double kNoise = 7;    // grey levels
  constexpr double kRound = 0.1;  // from here on it is a corner and no edge
  constexpr double kNotRound = 1e-4;
  const double inv_sigma_px = 1 / scales.sigma_px(keypoint.octave);
  const double share = keypoint.response > 0 ? kNoise / keypoint.response : 0;
  const double roundness = std::clamp(1e-4 * keypoint.roundness_per_10000, kNotRound, kRound);
  const double across = inv_sigma_px / std::sqrt(1 + share * share);
  const double along = inv_sigma_px / std::sqrt(1 + share * share * kRound / roundness);
  const double edge_rad = 1e-3 * keypoint.edge_mrad;
  const Eigen::Vector2d edge(std::cos(edge_rad), std::sin(edge_rad));
  return across * Eigen::Matrix2d::Identity() + (along - across) * (edge * edge.transpose());
}

}  // namespace vpslam
