#include "core/features/corner_refinement.h"

#include <algorithm>
#include <cstdint>

#include "core/features/multiversion.h"

namespace vpslam {
namespace {

constexpr int kCircle = 16;
// clang-format off
constexpr std::array<std::array<int, 2>, kCircle> kCirclePixels = {{
    {0, -3}, {1, -3}, {2, -2}, {3, -1}, {3, 0}, {3, 1}, {2, 2}, {1, 3},
    {0, 3}, {-1, 3}, {-2, 2}, {-3, 1}, {-3, 0}, {-3, -1}, {-2, -2}, {-1, -3}}};
// clang-format on

/// Minimum and maximum over runs of neighbours on the circle that begin at i.
struct Runs {
  static constexpr int kLength = 24;  // 16, and 8 more so that no index wraps around
  alignas(32) std::array<int16_t, kLength + 8> min, max;
};

/// Runs twice as long, of two that follow each other by `step`.
inline void Join(const Runs& runs, int step, Runs* joined) {
  for (int i = 0; i < Runs::kLength; ++i) {
    joined->min[i] = std::min(runs.min[i], runs.min[i + step]);
    joined->max[i] = std::max(runs.max[i], runs.max[i + step]);
  }
}

VPSLAM_MULTIVERSION
int ScoreAt(const uint8_t* p, const int* offsets) {
  // The last 8 entries are not used, but joined like all others.
  Runs of1{}, of2{}, of4{}, of8{};
  for (int i = 0; i < kCircle; ++i) of1.min[i] = static_cast<int16_t>(p[offsets[i]] - *p);
  std::copy_n(of1.min.begin(), 8, of1.min.begin() + kCircle);
  of1.max = of1.min;
  Join(of1, 1, &of2);
  Join(of2, 2, &of4);
  Join(of4, 4, &of8);
  int16_t score = INT16_MIN;
  for (int i = 0; i < kCircle; ++i) {
    const int16_t brighter = std::min(of8.min[i], of1.min[i + 8]);
    const int16_t darker = static_cast<int16_t>(-std::max(of8.max[i], of1.max[i + 8]));
    score = std::max(score, std::max(brighter, darker));
  }
  return score;
}

std::array<int, kCircle> Offsets(const cv::Mat& image) {
  std::array<int, kCircle> offsets;
  for (int i = 0; i < kCircle; ++i) {
    offsets[i] = kCirclePixels[i][0] + kCirclePixels[i][1] * static_cast<int>(image.step);
  }
  return offsets;
}

float Peak(int before, int here, int after) {
  const int curvature = before - 2 * here + after;
  if (curvature >= 0) return 0.0f;
  return std::clamp(0.5f * static_cast<float>(before - after) / static_cast<float>(curvature),
                    -0.5f, 0.5f);
}

}  // namespace

int SegmentScore(const cv::Mat& image, int x, int y) {
  return ScoreAt(image.ptr<uint8_t>(y) + x, Offsets(image).data());
}

std::array<float, 2> SubpixelOffset(const cv::Mat& image, int x, int y) {
  const std::array<int, kCircle> offsets = Offsets(image);
  const uint8_t* p = image.ptr<uint8_t>(y) + x;
  const int step = static_cast<int>(image.step);
  const int here = ScoreAt(p, offsets.data());
  return {Peak(ScoreAt(p - 1, offsets.data()), here, ScoreAt(p + 1, offsets.data())),
          Peak(ScoreAt(p - step, offsets.data()), here, ScoreAt(p + step, offsets.data()))};
}

}  // namespace vpslam
