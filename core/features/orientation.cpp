#include "core/features/orientation.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/features/multiversion.h"

namespace vpslam {
namespace {

constexpr int kRadius = kOrientationRadius_px;
constexpr int kRowLength = 2 * kRadius + 1;

/// weights[r][c]: x of the column if (c, r) lies in the disc, else 0; `inside` 1 or 0 alike.
struct Disc {
  std::array<std::array<int16_t, kRowLength + 1>, kRowLength> x{};
  std::array<std::array<int16_t, kRowLength + 1>, kRowLength> inside{};
  constexpr Disc() {
    for (int dy = -kRadius; dy <= kRadius; ++dy) {
      for (int dx = -kRadius; dx <= kRadius; ++dx) {
        // Half a pixel more than the radius makes the rounded disc symmetric in x and y.
        if (4 * (dx * dx + dy * dy) > (2 * kRadius + 1) * (2 * kRadius + 1)) continue;
        x[dy + kRadius][dx + kRadius] = static_cast<int16_t>(dx);
        inside[dy + kRadius][dx + kRadius] = 1;
      }
    }
  }
};
constexpr Disc kDisc;

struct Moments {
  int x, y;
};

VPSLAM_MULTIVERSION
Moments DiscMoments(const uint8_t* centre, std::ptrdiff_t step) {
  Moments m{0, 0};
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    const uint8_t* row = centre + dy * step - kRadius;
    const int16_t* x = kDisc.x[dy + kRadius].data();
    const int16_t* inside = kDisc.inside[dy + kRadius].data();
    int sum_x = 0, sum = 0;
    for (int c = 0; c < kRowLength; ++c) {
      sum_x += x[c] * static_cast<int16_t>(row[c]);
      sum += inside[c] * static_cast<int16_t>(row[c]);
    }
    m.x += sum_x;
    m.y += dy * sum;
  }
  return m;
}

}  // namespace

float Orientation_rad(const cv::Mat& image, int x, int y) {
  const Moments m = DiscMoments(image.ptr<uint8_t>(y) + x, static_cast<std::ptrdiff_t>(image.step));
  constexpr float kTwoPi = 2 * std::numbers::pi_v<float>;
  float angle = std::atan2(static_cast<float>(m.y), static_cast<float>(m.x));
  if (angle < 0) angle += kTwoPi;
  return angle < kTwoPi ? angle : 0.0f;  // a tiny negative angle may round up to 2 pi
}

}  // namespace vpslam
