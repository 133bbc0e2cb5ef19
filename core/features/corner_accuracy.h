// How well a corner's position is known.
#pragma once

#include <Eigen/Core>

#include "core/features/features.h"
#include "core/features/scale_levels.h"

namespace vpslam {

/// Square root of the information by which a corner is weighted, 2 x 2 and symmetric, 1 / px of
/// level 0: times a residual it gives sigmas.
///
/// The standard deviation is that of the octave, and more for weak corners: noise moves a corner by
/// its own size over the corner's strength, so that at a FAST score of kNoise the variance is twice
/// that of a strong corner. A score that is not known (0) counts as strong. Along an edge the
/// corner is as much weaker as its roundness falls short of kRound, and may be found anywhere in
/// the end.
Eigen::Matrix2d CornerSqrtInformation(const Keypoint& keypoint, const ScalePyramid& scales);

}  // namespace vpslam
