// Steered BRIEF [Rublee11 sec. 4]: 256 comparisons of pixel pairs of the smoothed image around a
// corner, the pairs turned by the corner's orientation.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/features/features.h"
#include "core/features/orb_pattern.h"

namespace vpslam {

/// Pixel of the disc of kPatternRadius_px nearest to (x, y) turned by `angle_rad`.
std::array<int, 2> TurnedPixel(int x, int y, double angle_rad);

class OrbDescriber {
 public:
  /// For images with `row_step` bytes between rows.
  OrbDescriber(std::ptrdiff_t row_step, const std::array<PatternPair, 256>& pattern);

  /// Descriptor of the corner at `centre`, a pixel of a smoothed image that keeps kPatternRadius_px
  /// from its border. The angle, in [0, 2 pi), is rounded to one of kNumAngles.
  Descriptor Describe(const uint8_t* centre, float angle_rad) const;

  static constexpr int kNumAngles = 256;

 private:
  static constexpr int kNumPixels = 512;
  std::vector<int32_t> offsets_;  ///< kNumAngles x 256 x (first, second), in bytes
};

}  // namespace vpslam
