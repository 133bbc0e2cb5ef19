#include "core/features/corner_detector.h"

#include <algorithm>

#include <opencv2/features2d.hpp>

namespace vpslam {

void CornerDetector::DetectIn(const cv::Mat& image, const cv::Rect& region, int threshold,
                              std::vector<Corner>* corners) {
  // The segment test looks 3 px around a pixel, and the suppression of non-maxima 1 px further.
  constexpr int kReach = 4;
  const cv::Rect searched(region.x - kReach, region.y - kReach, region.width + 2 * kReach,
                          region.height + 2 * kReach);
  cv::FAST(image(searched), found_, threshold, true);
  for (const cv::KeyPoint& k : found_) {
    const cv::Point p(static_cast<int>(k.pt.x) + searched.x, static_cast<int>(k.pt.y) + searched.y);
    if (region.contains(p)) corners->push_back({p.x, p.y, static_cast<int>(k.response)});
  }
}

void CornerDetector::Detect(const cv::Mat& image, std::vector<Corner>* corners) {
  corners->clear();
  const int margin = options_.margin_px;
  const cv::Rect region(margin, margin, image.cols - 2 * margin, image.rows - 2 * margin);
  if (region.width <= 0 || region.height <= 0) return;
  DetectIn(image, region, options_.threshold, corners);
  if (options_.threshold_low >= options_.threshold) return;

  const int cell = options_.cell_px;
  const int columns = (region.width + cell - 1) / cell, rows = (region.height + cell - 1) / cell;
  occupied_.assign(static_cast<size_t>(columns) * rows, 0);
  for (const Corner& c : *corners) {
    occupied_[(c.y - region.y) / cell * columns + (c.x - region.x) / cell] = 1;
  }
  for (int row = 0; row < rows; ++row) {
    const int y = region.y + row * cell;
    const int height = std::min(cell, region.y + region.height - y);
    // Neighbouring empty cells are searched in one go: FAST is local, so the result is the same.
    for (int begin = 0; begin < columns;) {
      if (occupied_[row * columns + begin]) {
        ++begin;
        continue;
      }
      int end = begin + 1;
      while (end < columns && !occupied_[row * columns + end]) ++end;
      const int x = region.x + begin * cell;
      const int width = std::min((end - begin) * cell, region.x + region.width - x);
      DetectIn(image, {x, y, width, height}, options_.threshold_low, corners);
      begin = end;
    }
  }
}

}  // namespace vpslam
