// The point features of one image, as they travel and as they are stored: ORB descriptors of
// key points in undistorted pixel coordinates.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/description.h"

namespace vpslam {

/// 256 bits of ORB or LBD.
using Descriptor = std::array<uint64_t, 4>;

/// Hamming distance, 0 to 256.
inline int Distance(const Descriptor& a, const Descriptor& b) {
  return std::popcount(a[0] ^ b[0]) + std::popcount(a[1] ^ b[1]) + std::popcount(a[2] ^ b[2]) +
         std::popcount(a[3] ^ b[3]);
}

/// Single precision on purpose: exactly what messages and logs hold, so that a replay computes with
/// the same numbers as the live run.
struct Keypoint {
  float x_px = 0;  ///< undistorted, level-0 pixels
  float y_px = 0;
  float angle_rad = 0;  ///< orientation, in [0, 2 pi)
  float response = 0;   ///< FAST score
  int32_t octave = 0;   ///< pyramid level
  /// 10000: known alike in all directions, 0: on a straight edge (core/features/edge_shape.h).
  int16_t roundness_per_10000 = 10000;
  int16_t edge_mrad = 0;  ///< direction of that edge, in [0, 1000 pi)

  Eigen::Vector2d Position() const { return {x_px, y_px}; }

  static constexpr const char* kWireName = "keypoint_t";
  static void Describe(auto& v, auto& m) {
    auto& [x_px, y_px, angle_rad, response, octave, roundness_per_10000, edge_mrad] = m;
    v("x_px", x_px, kPixel);
    v("y_px", y_px, kPixel);
    v("angle_rad", angle_rad, Within{-10, 10});
    v("response", response);
    v("octave", octave, Between{0, 32});
    v("roundness_per_10000", roundness_per_10000, Between{0, 10000});
    v("edge_mrad", edge_mrad);
  }
};

/// keypoints[i] belongs to descriptors[i].
struct Features {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;

  int size() const { return static_cast<int>(keypoints.size()); }
};

}  // namespace vpslam
