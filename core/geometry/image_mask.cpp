#include "core/geometry/image_mask.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace vpslam {

std::vector<int32_t> MaskRuns(std::span<const uint8_t> hidden) {
  std::vector<int32_t> runs;
  bool in_hidden = false;
  int32_t length = 0;
  for (const uint8_t value : hidden) {
    if ((value != 0) != in_hidden) {
      runs.push_back(length);
      length = 0;
      in_hidden = !in_hidden;
    }
    ++length;
  }
  if (runs.empty() && !in_hidden) return {};
  runs.push_back(length);
  return runs;
}

std::optional<std::string> ImageMask::Fault(std::span<const int32_t> runs, int width, int height) {
  if (runs.empty()) return std::nullopt;
  if (runs.size() > kMaxRuns) return "the mask is too ragged; draw it with smooth borders";
  int64_t seen = 0, hidden = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (runs[i] < (i == 0 ? 0 : 1)) return "the mask has an empty run";
    (i % 2 == 0 ? seen : hidden) += runs[i];
  }
  if (seen + hidden != int64_t{width} * height) return "the mask is not of the image's size";
  if (seen == 0) return "the mask hides the whole image; what it hides is black, the rest white";
  return std::nullopt;
}

ImageMask::ImageMask(std::span<const int32_t> runs, int width, int height)
    : width_(width), height_(height) {
  if (runs.empty()) return;
  hidden_.reserve(static_cast<std::size_t>(width) * height);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    hidden_.insert(hidden_.end(), static_cast<std::size_t>(runs[i]), static_cast<uint8_t>(i % 2));
  }
}

bool ImageMask::Hides(const Eigen::Vector2d& distorted_px) const {
  if (hidden_.empty()) return false;
  const double x = std::round(distorted_px.x()), y = std::round(distorted_px.y());
  if (!(x >= 0 && x < width_ && y >= 0 && y < height_)) return false;
  return hidden_[static_cast<std::size_t>(y) * width_ + static_cast<std::size_t>(x)] != 0;
}

std::vector<int32_t> ImageMask::Scaled(int width, int height) const {
  if (hidden_.empty()) return {};
  std::vector<uint8_t> scaled(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y) {
    const int64_t row = (2 * y + 1) * int64_t{height_} / (2 * int64_t{height});
    for (int x = 0; x < width; ++x) {
      const int64_t column = (2 * x + 1) * int64_t{width_} / (2 * int64_t{width});
      scaled[static_cast<std::size_t>(y) * width + x] =
          hidden_[static_cast<std::size_t>(row * width_ + column)];
    }
  }
  return MaskRuns(scaled);
}

std::optional<SeenPart> LongestSeenPart(const ImageMask& mask, const Eigen::Vector2d& start_px,
                                        const Eigen::Vector2d& end_px, double margin_px) {
  if (!mask.HidesAnything()) return SeenPart{start_px, end_px};
  const double length_px = (end_px - start_px).norm();
  const int steps = std::max(1, static_cast<int>(std::ceil(2 * length_px)));
  const auto at = [&](int i) -> Eigen::Vector2d {
    return start_px + (end_px - start_px) * (static_cast<double>(i) / steps);
  };
  int best_begin = 0, best_end = -1;  // both included
  for (int i = 0; i <= steps; ++i) {
    if (mask.Hides(at(i))) continue;
    int end = i;
    while (end < steps && !mask.Hides(at(end + 1))) ++end;
    if (end - i > best_end - best_begin) best_begin = i, best_end = end;
    i = end;
  }
  if (best_end < best_begin) return std::nullopt;
  const Eigen::Vector2d along =
      length_px > 0 ? Eigen::Vector2d((end_px - start_px) / length_px) : Eigen::Vector2d::Zero();
  const double margin_before = best_begin == 0 ? 0 : margin_px;
  const double margin_after = best_end == steps ? 0 : margin_px;
  const Eigen::Vector2d begin = at(best_begin), end = at(best_end);
  if ((end - begin).norm() <= margin_before + margin_after) return std::nullopt;
  return SeenPart{begin + margin_before * along, end - margin_after * along};
}

}  // namespace vpslam
