// The picture that people see: the frame, its lines in the colours of the directions they point to,
// and the points that were tracked in it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "core/features/line_set.h"
#include "core/geometry/camera.h"

namespace vpslam {

struct PreviewScene {
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  cv::Mat image;                              ///< CV_8UC1 as the lens sees it; empty: black
  std::vector<Eigen::Vector2f> tracked_px;    ///< undistorted
  std::shared_ptr<const LineSet> lines = {};  ///< nullptr: none
};

class PreviewPainter {
 public:
  static constexpr int kMaxWidth = 640;  ///< px; larger images are shrunk

  explicit PreviewPainter(const Camera& camera) : camera_(camera) {}

  /// BGR. Lines of the first three vanishing points are red, green and blue, others grey; a
  /// direction keeps its colour from one picture to the next. Tracked points are green squares.
  cv::Mat Paint(const PreviewScene& scene);

 private:
  /// Per vanishing point its colour's number, or -1.
  std::vector<int> ColoursOf(const LineSet& lines);

  const Camera camera_;
  std::array<std::optional<Eigen::Vector3d>, 3> directions_;  ///< that had the colours last
};

/// A JPEG of at most `max_bytes`, as good as fits; at need of a smaller picture. Empty if even that
/// is too much.
std::vector<uint8_t> CompressToFit(const cv::Mat& picture, std::size_t max_bytes);

}  // namespace vpslam
