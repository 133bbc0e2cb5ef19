// The pairs of pixels that the descriptor compares.
#pragma once

#include <array>
#include <cstdint>

namespace vpslam {

/// All pairs lie in a disc of this radius around the corner.
inline constexpr int kPatternRadius_px = 15;

/// Bit: smoothed image at (x1, y1) < at (x2, y2), px from the corner, x axis along its orientation.
struct PatternPair {
  int8_t x1, y1, x2, y2;
};

/// Chosen by core/features/learn_orb_pattern.cpp.
extern const std::array<PatternPair, 256> kOrbPattern;

}  // namespace vpslam
