#include "core/features/smoothing.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "core/features/multiversion.h"

namespace vpslam {
namespace {

constexpr int kReach = 3;
// exp(-i^2 / 8), scaled such that 56 + 2 (48 + 34 + 18) = 256.
constexpr uint16_t kWeight0 = 56, kWeight1 = 48, kWeight2 = 34, kWeight3 = 18;

/// out[i] = weighted sum of the seven taps at i. The largest, 256 x 255 + 128, fits 16 bits.
VPSLAM_MULTIVERSION
void Combine(const uint8_t* const* taps, int count, uint8_t* out) {
  const uint8_t *m3 = taps[0], *m2 = taps[1], *m1 = taps[2], *c = taps[3], *p1 = taps[4],
                *p2 = taps[5], *p3 = taps[6];
  for (int i = 0; i < count; ++i) {
    const uint16_t outer = static_cast<uint16_t>(m3[i] + p3[i]);
    const uint16_t middle = static_cast<uint16_t>(m2[i] + p2[i]);
    const uint16_t inner = static_cast<uint16_t>(m1[i] + p1[i]);
    const uint16_t sum = static_cast<uint16_t>(kWeight0 * c[i] + kWeight1 * inner +
                                               kWeight2 * middle + kWeight3 * outer + 128);
    out[i] = static_cast<uint8_t>(sum >> 8);
  }
}

}  // namespace

void Smoother::Smooth(const cv::Mat& image, cv::Mat* smoothed) {
  const int width = image.cols, last = image.rows - 1;
  row_.resize(static_cast<size_t>(width) + 2 * kReach);
  uint8_t* row = row_.data() + kReach;
  std::array<const uint8_t*, 2 * kReach + 1> taps;
  for (int y = 0; y <= last; ++y) {
    for (int k = -kReach; k <= kReach; ++k) {
      taps[k + kReach] = image.ptr<uint8_t>(last - std::abs(last - std::abs(y + k)));
    }
    Combine(taps.data(), width, row);
    for (int k = 1; k <= kReach; ++k) {
      row[-k] = row[k];
      row[width - 1 + k] = row[width - 1 - k];
    }
    for (int k = -kReach; k <= kReach; ++k) taps[k + kReach] = row + k;
    Combine(taps.data(), width, smoothed->ptr<uint8_t>(y));
  }
}

}  // namespace vpslam
