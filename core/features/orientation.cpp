#include "core/features/orientation.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <opencv2/core/hal/intrin.hpp>

namespace vpslam {
namespace {

constexpr int kRadius = kOrientationRadius_px;
/// A row is read in two halves of equal length, which share the middle column, so that the vector
/// instructions have full registers and nothing beyond the disc is read.
constexpr int kHalf = kRadius + 1;
constexpr int kLanes = 8;
static_assert(kHalf % kLanes == 0);
constexpr int kRows = 2 * kRadius + 1;
constexpr int kNumWeights = kRows * 2 * kHalf;

/// Weights of the grey values in the order they are read: x or y if in the disc, else 0.
struct Disc {
  std::array<int16_t, kNumWeights> x{}, y{};
  constexpr Disc() {
    int i = 0;
    for (int dy = -kRadius; dy <= kRadius; ++dy) {
      for (const int begin : {-kRadius, 0}) {
        for (int dx = begin; dx < begin + kHalf; ++dx, ++i) {
          // Half a pixel more than the radius makes the rounded disc symmetric in x and y.
          if (4 * (dx * dx + dy * dy) > (2 * kRadius + 1) * (2 * kRadius + 1)) continue;
          const bool counted_before = begin == 0 && dx == 0;
          x[i] = static_cast<int16_t>(dx);
          y[i] = counted_before ? int16_t{0} : static_cast<int16_t>(dy);
        }
      }
    }
  }
};
constexpr Disc kDisc;

struct Moments {
  int x, y;
};

Moments DiscMoments(const uint8_t* centre, std::ptrdiff_t step) {
  const int16_t* weight_x = kDisc.x.data();
  const int16_t* weight_y = kDisc.y.data();
  cv::v_int32x4 sum_x = cv::v_setzero_s32(), sum_y = cv::v_setzero_s32();
  const auto add_eight = [&](const uint8_t* pixels) {
    const cv::v_int16x8 grey = cv::v_reinterpret_as_s16(cv::v_load_expand(pixels));
    sum_x += cv::v_dotprod(grey, cv::v_load(weight_x));
    sum_y += cv::v_dotprod(grey, cv::v_load(weight_y));
    weight_x += kLanes;
    weight_y += kLanes;
  };
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    const uint8_t* row = centre + dy * step;
    for (const uint8_t* half : {row - kRadius, row}) {
      for (int c = 0; c < kHalf; c += kLanes) add_eight(half + c);
    }
  }
  return {cv::v_reduce_sum(sum_x), cv::v_reduce_sum(sum_y)};
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
