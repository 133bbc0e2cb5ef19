// Steered BRIEF [Rublee11 sec. 4]: 256 comparisons of pixel pairs of the smoothed image around a
// corner, the pairs turned by the corner's orientation.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/features/corner_detector.h"
#include "core/features/features.h"

namespace vpslam {

/// Distance that a corner must keep from the border of its image to be described.
inline constexpr int kDescriptorMargin_px = 19;

/// Descriptors of `corners` with orientations `angles_rad` in `image` (CV_8UC1, not smoothed).
std::vector<Descriptor> Describe(const cv::Mat& image, const std::vector<Corner>& corners,
                                 const std::vector<float>& angles_rad);

}  // namespace vpslam
