#include "vpdetector/line_descriptor.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace vpslam {
namespace {

constexpr int kBands = 9;  // [Zhang13] sec. 3.1
constexpr int kRowsPerBand = 7;
constexpr int kRows = kBands * kRowsPerBand;
constexpr int kSums = 4;  // along the normal +, -; along the direction +, -

struct RowWeights {
  std::array<float, kRows> global;            ///< falls with the distance from the segment
  std::array<float, 3 * kRowsPerBand> local;  ///< falls with the distance from the band's middle

  RowWeights() {
    const double sigma_global = 0.5 * (kRows - 1);
    for (int row = 0; row < kRows; ++row) {
      const double d = row - 0.5 * (kRows - 1);
      global[static_cast<size_t>(row)] =
          static_cast<float>(std::exp(-0.5 * d * d / (sigma_global * sigma_global)));
    }
    const double sigma_local = kRowsPerBand;
    for (int row = 0; row < 3 * kRowsPerBand; ++row) {
      const double d = row - 0.5 * (3 * kRowsPerBand - 1);
      local[static_cast<size_t>(row)] =
          static_cast<float>(std::exp(-0.5 * d * d / (sigma_local * sigma_local)));
    }
  }
};

/// Points along a segment, straight pieces between them.
using LinePath = std::vector<Eigen::Vector2d>;

/// The way of a segment through the distorted image.
LinePath DistortedPath(const Camera& camera, const EdgeSegment& s) {
  if (!camera.HasDistortion()) return {s.start_px, s.end_px};
  constexpr double kPiece_px = 16;  // a lens bends that little by less than a tenth of a px
  const int pieces = 1 + static_cast<int>(s.Length() / kPiece_px);
  LinePath path;
  path.reserve(static_cast<size_t>(pieces) + 1);
  for (int i = 0; i <= pieces; ++i) {
    const double f = static_cast<double>(i) / pieces;
    path.push_back(camera.Distort((1 - f) * s.start_px + f * s.end_px));
  }
  return path;
}

/// Points at even steps along the path.
std::vector<Eigen::Vector2f> Resample(const LinePath& path, int count) {
  std::vector<double> at(path.size(), 0.0);
  for (size_t i = 1; i < path.size(); ++i) at[i] = at[i - 1] + (path[i] - path[i - 1]).norm();
  std::vector<Eigen::Vector2f> points;
  points.reserve(static_cast<size_t>(count));
  size_t piece = 1;
  for (int s = 0; s < count; ++s) {
    const double where = at.back() * (s + 0.5) / count;
    while (piece + 1 < path.size() && at[piece] < where) ++piece;
    const double length = at[piece] - at[piece - 1];
    const double f = length > 0 ? (where - at[piece - 1]) / length : 0.0;
    points.push_back(((1 - f) * path[piece - 1] + f * path[piece]).cast<float>());
  }
  return points;
}

Descriptor Describe(const cv::Mat& gradient, const LinePath& path, int max_samples,
                    const RowWeights& weights) {
  Descriptor bits{};
  if (path.size() < 2) return bits;
  const Eigen::Vector2d chord = path.back() - path.front();
  const double length = chord.norm();
  if (!(length > 0) || !std::isfinite(length)) return bits;
  const float dx = static_cast<float>(chord.x() / length);
  const float dy = static_cast<float>(chord.y() / length);
  const float nx = -dy, ny = dx;
  const int count = std::clamp(static_cast<int>(length), 1, max_samples);
  const std::vector<Eigen::Vector2f> centres = Resample(path, count);

  std::array<std::array<float, kSums>, kRows> sums;
  const float max_x = static_cast<float>(gradient.cols - 1);
  const float max_y = static_cast<float>(gradient.rows - 1);
  for (int row = 0; row < kRows; ++row) {
    const float offset = static_cast<float>(row - kRows / 2);
    // Added up as |g| and g: the positive part is half their sum, the negative half the difference.
    float normal = 0, normal_abs = 0, along = 0, along_abs = 0;
    for (const Eigen::Vector2f& centre : centres) {
      const float x = std::clamp(centre.x() + offset * nx, 0.0f, max_x);
      const float y = std::clamp(centre.y() + offset * ny, 0.0f, max_y);
      const auto g =
          gradient.ptr<cv::Vec2s>(static_cast<int>(y + 0.5f))[static_cast<int>(x + 0.5f)];
      const float gx = g[0], gy = g[1];
      const float gn = gx * nx + gy * ny;
      const float gd = gx * dx + gy * dy;
      normal += gn;
      normal_abs += std::abs(gn);
      along += gd;
      along_abs += std::abs(gd);
    }
    const float w = 0.5f * weights.global[static_cast<size_t>(row)];
    sums[static_cast<size_t>(row)] = {w * (normal_abs + normal), w * (normal_abs - normal),
                                      w * (along_abs + along), w * (along_abs - along)};
  }

  // Mean and standard deviation over the band and its neighbours.
  std::array<std::array<float, 2 * kSums>, kBands> bands;
  for (int band = 0; band < kBands; ++band) {
    const int first = (band - 1) * kRowsPerBand;
    std::array<float, kSums> sum{}, square{};
    int rows = 0;
    for (int i = 0; i < 3 * kRowsPerBand; ++i) {
      const int row = first + i;
      if (row < 0 || row >= kRows) continue;
      ++rows;
      for (size_t k = 0; k < kSums; ++k) {
        const float value =
            weights.local[static_cast<size_t>(i)] * sums[static_cast<size_t>(row)][k];
        sum[k] += value;
        square[k] += value * value;
      }
    }
    for (size_t k = 0; k < kSums; ++k) {
      const float mean = sum[k] / static_cast<float>(rows);
      const float variance = square[k] / static_cast<float>(rows) - mean * mean;
      bands[static_cast<size_t>(band)][k] = mean;
      bands[static_cast<size_t>(band)][kSums + k] = std::sqrt(std::max(0.0f, variance));
    }
  }

  // 9 bands make 36 pairs; the four of the widest distance but one are left out to get 256 bits.
  size_t bit = 0;
  for (size_t distance = 1; distance < kBands; ++distance) {
    for (size_t a = 0; a + distance < kBands && bit < 256; ++a) {
      for (size_t k = 0; k < 2 * kSums; ++k, ++bit) {
        if (bands[a][k] > bands[a + distance][k]) bits[bit / 64] |= uint64_t{1} << (bit % 64);
      }
    }
  }
  return bits;
}

}  // namespace

std::optional<std::string> LineDescriptorOptions::Validate() const {
  if (!(min_length_px >= 0)) return "min_length_px must not be negative";
  if (max_lines < 0) return "max_lines must not be negative";
  if (max_samples < 4 || max_samples > 4096) return "max_samples must lie in 4 to 4096";
  return std::nullopt;
}

std::vector<Descriptor> DescribeLines(const cv::Mat& gray, const Camera& camera,
                                      const std::vector<EdgeSegment>& segments,
                                      const LineDescriptorOptions& options) {
  CV_Assert(gray.type() == CV_8UC1);
  std::vector<LinePath> paths;
  for (const EdgeSegment& s : segments) {
    if (s.Length() < options.min_length_px) break;
    if (static_cast<int>(paths.size()) >= options.max_lines) break;
    paths.push_back(DistortedPath(camera, s));
  }
  std::vector<Descriptor> descriptors;
  if (paths.empty() || gray.empty()) return descriptors;
  static const RowWeights kWeights;
  cv::Mat smooth, derivatives[2], gradient;
  // Isolated: of a part of a larger image nothing outside of it counts.
  cv::GaussianBlur(gray, smooth, cv::Size(5, 5), 1.0, 1.0,
                   cv::BORDER_DEFAULT | cv::BORDER_ISOLATED);
  cv::Sobel(smooth, derivatives[0], CV_16S, 1, 0);
  cv::Sobel(smooth, derivatives[1], CV_16S, 0, 1);
  cv::merge(derivatives, 2, gradient);
  descriptors.reserve(paths.size());
  for (const LinePath& path : paths) {
    descriptors.push_back(Describe(gradient, path, options.max_samples, kWeights));
  }
  return descriptors;
}

}  // namespace vpslam
