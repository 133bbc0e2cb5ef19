// How well a corner's position is known.
#pragma once

#include <cmath>

#include "core/features/features.h"
#include "core/features/scale_levels.h"

namespace vpslam {

/// Standard deviation of the coordinates by which a measurement is weighted, level-0 px: that of
/// the octave, and more for weak corners. Noise moves a corner by its own size over the corner's
/// strength, so that at a FAST score of kNoise the variance is twice that of a strong corner. A
/// score that is not known (0) counts as strong.
inline double CornerSigma_px(const Keypoint& keypoint, const ScalePyramid& scales) {
  constexpr double kNoise = 7;  // grey levels
  const double noise_share = keypoint.response > 0 ? kNoise / keypoint.response : 0;
  return scales.sigma_px(keypoint.octave) * std::sqrt(1 + noise_share * noise_share);
}

}  // namespace vpslam
