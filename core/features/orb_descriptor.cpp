#include "core/features/orb_descriptor.h"

#include <cmath>
#include <numbers>

namespace vpslam {

std::array<int, 2> TurnedPixel(int x, int y, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {static_cast<int>(std::lround(c * x - s * y)),
          static_cast<int>(std::lround(s * x + c * y))};
}

OrbDescriber::OrbDescriber(std::ptrdiff_t row_step, const std::array<PatternPair, 256>& pattern) {
  offsets_.reserve(static_cast<size_t>(kNumAngles) * kNumPixels);
  const auto append = [&](int x, int y, double angle_rad) {
    const auto [column, row] = TurnedPixel(x, y, angle_rad);
    offsets_.push_back(static_cast<int32_t>(row * row_step + column));
  };
  for (int i = 0; i < kNumAngles; ++i) {
    const double angle_rad = 2 * std::numbers::pi * i / kNumAngles;
    for (const PatternPair& p : pattern) {
      append(p.x1, p.y1, angle_rad);
      append(p.x2, p.y2, angle_rad);
    }
  }
}

Descriptor OrbDescriber::Describe(const uint8_t* centre, float angle_rad) const {
  constexpr float kAnglesPerRad = kNumAngles / (2 * std::numbers::pi_v<float>);
  const int angle = static_cast<int>(angle_rad * kAnglesPerRad + 0.5f) % kNumAngles;
  const int32_t* offset = &offsets_[static_cast<size_t>(angle) * kNumPixels];
  Descriptor descriptor;
  for (uint64_t& word : descriptor) {
    uint64_t bits = 0;
    for (int b = 0; b < 64; ++b, offset += 2) {
      bits |= static_cast<uint64_t>(centre[offset[0]] < centre[offset[1]]) << b;
    }
    word = bits;
  }
  return descriptor;
}

}  // namespace vpslam
