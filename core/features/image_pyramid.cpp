#include "core/features/image_pyramid.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace vpslam {

std::vector<cv::Mat> AllocateLevels(const std::vector<cv::Size>& sizes, cv::Mat* buffer) {
  int width = 0, height = 0;
  for (const cv::Size& size : sizes) {
    width = std::max(width, size.width);
    height += size.height;
  }
  constexpr int kAlignment = 64;  // rows begin on cache lines
  width = (width + kAlignment - 1) / kAlignment * kAlignment;
  std::vector<cv::Mat> levels;
  if (sizes.empty()) return levels;
  buffer->create(height, width, CV_8UC1);
  int y = 0;
  for (const cv::Size& size : sizes) {
    levels.push_back((*buffer)(cv::Rect({0, y}, size)));
    y += size.height;
  }
  return levels;
}

ImagePyramid::ImagePyramid(int width, int height, const ScalePyramid& scales, int min_level_px) {
  std::vector<cv::Size> sizes;
  for (int i = 0; i < scales.num_levels(); ++i) {
    const cv::Size size(static_cast<int>(std::lround(width / scales.scale(i))),
                        static_cast<int>(std::lround(height / scales.scale(i))));
    if (std::min(size.width, size.height) < min_level_px) break;
    sizes.push_back(size);
    ratio_x_.push_back(static_cast<float>(width) / static_cast<float>(size.width));
    ratio_y_.push_back(static_cast<float>(height) / static_cast<float>(size.height));
  }
  levels_ = AllocateLevels(sizes, &buffer_);
}

void ImagePyramid::Build(const cv::Mat& image) {
  for (int i = 0; i < num_levels(); ++i) {
    if (i == 0) {
      image.copyTo(levels_[0]);
    } else {
      cv::resize(levels_[i - 1], levels_[i], levels_[i].size(), 0, 0, cv::INTER_LINEAR);
    }
  }
}

}  // namespace vpslam
