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

VPSLAM_MULTIVERSION
int ScoreAt(const uint8_t* p, const int* offsets) {
  // Differences around the circle, twice, so that no index wraps around. Then minimum and
  // maximum over 2, 4, 8, 9 neighbours, each from the one before.
  std::array<int16_t, 2 * kCircle> low, high;
  for (int i = 0; i < kCircle; ++i) {
    const int16_t difference = static_cast<int16_t>(p[offsets[i]] - *p);
    low[i] = low[i + kCircle] = high[i] = high[i + kCircle] = difference;
  }
  const std::array<int16_t, 2 * kCircle> differences = low;
  for (const int step : {1, 2, 4}) {
    for (int i = 0; i < 2 * kCircle - step; ++i) {
      low[i] = std::min(low[i], low[i + step]);
      high[i] = std::max(high[i], high[i + step]);
    }
  }
  int16_t brighter = INT16_MIN, darker = INT16_MIN;
  for (int i = 0; i < kCircle; ++i) {
    brighter = std::max(brighter, std::min(low[i], differences[i + 8]));
    darker = std::max(darker, static_cast<int16_t>(-std::max(high[i], differences[i + 8])));
  }
  return std::max(brighter, darker);
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
