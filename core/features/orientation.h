// Orientation of a corner by its intensity centroid [Rublee11 sec. 3.2].
#pragma once

#include <opencv2/core/mat.hpp>

namespace vpslam {

/// The disc around the corner has this radius.
inline constexpr int kOrientationRadius_px = 15;

/// Direction from the pixel (x, y) to the centroid of the disc around it, in [0, 2 pi), from the x
/// axis towards the y axis. The disc must lie in the image (CV_8UC1). 0 if the disc is uniform.
float Orientation_rad(const cv::Mat& image, int x, int y);

}  // namespace vpslam
