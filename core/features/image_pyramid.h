// One image at several scales.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>

#include "core/features/scale_levels.h"

namespace vpslam {

/// The levels share one buffer, thus one row step, so that offsets between pixels are the same on
/// all of them.
class ImagePyramid {
 public:
  /// Levels smaller than `min_level_px` on a side are left out.
  ImagePyramid(int width, int height, const ScalePyramid& scales, int min_level_px);

  /// `image` is CV_8UC1 of the size given above. Each level is made from the one before it.
  void Build(const cv::Mat& image);

  int num_levels() const { return static_cast<int>(levels_.size()); }
  const cv::Mat& level(int octave) const { return levels_[octave]; }

  /// Pixel centres have integer coordinates on every level, so pixel 0 of a coarse level lies half
  /// a coarse pixel from the border, and that is not at 0 on level 0.
  float ToLevelZeroX(int octave, float x) const { return (x + 0.5f) * ratio_x_[octave] - 0.5f; }
  float ToLevelZeroY(int octave, float y) const { return (y + 0.5f) * ratio_y_[octave] - 0.5f; }

 private:
  cv::Mat buffer_;
  std::vector<cv::Mat> levels_;           ///< into buffer_
  std::vector<float> ratio_x_, ratio_y_;  ///< level 0 size / size; sizes are rounded to pixels
};

/// Room for one image per level, all with one row step, as ImagePyramid has it.
std::vector<cv::Mat> AllocateLevels(const std::vector<cv::Size>& sizes, cv::Mat* buffer);

}  // namespace vpslam
