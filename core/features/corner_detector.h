// FAST corners [Rosten06, "Machine learning for high-speed corner detection", ECCV 2006] of one
// image, by two thresholds.
#pragma once

#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

namespace vpslam {

struct Corner {
  int x = 0, y = 0;  ///< px of the image searched
  int score = 0;     ///< highest threshold at which it still is a corner, 1 to 255
};

struct CornerDetectorOptions {
  int threshold = 20;
  int threshold_low = 7;  ///< used in cells without any corner at `threshold`
  int cell_px = 32;       ///< side of such a cell
  int margin_px = 16;     ///< nothing is found nearer than that to the border; at least 4
};

class CornerDetector {
 public:
  explicit CornerDetector(const CornerDetectorOptions& options) : options_(options) {}

  /// Local maxima of the score, in an order that depends on the image alone. `image` is CV_8UC1.
  void Detect(const cv::Mat& image, std::vector<Corner>* corners);

 private:
  void DetectIn(const cv::Mat& image, const cv::Rect& region, int threshold,
                std::vector<Corner>* corners);

  CornerDetectorOptions options_;
  std::vector<cv::KeyPoint> found_;
  std::vector<char> occupied_;
};

}  // namespace vpslam
