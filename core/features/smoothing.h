// Gaussian smoothing of 8-bit images: what the descriptor compares.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace vpslam {

/// Sigma 2 px, cut off at 3 px, weights in 1/256, rounded after each direction. Twice as fast as
/// cv::GaussianBlur, which does the same to within a grey level.
class Smoother {
 public:
  /// `smoothed` has the size of `image` already; both are CV_8UC1 and at least 4 px wide and high.
  /// Beyond the border the image is mirrored, without repeating the border itself.
  void Smooth(const cv::Mat& image, cv::Mat* smoothed);

 private:
  std::vector<uint8_t> row_;  ///< smoothed along y, with 3 px more at both ends
};

}  // namespace vpslam
