// Choice of corners that cover the image evenly.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/types.hpp>

#include "core/features/corner_detector.h"

namespace vpslam {

/// Suppression via square covering, after [Bailo18, "Efficient adaptive non-maximal suppression
/// algorithms for homogeneous spatial keypoint distribution", Pattern Recognition Letters 106]:
/// corners are taken from strong to weak, each one covering a square around it in which no other is
/// taken; the side of the square that leaves the wanted number is found by bisection.
class KeypointDistribution {
 public:
  /// Keeps at most `wanted` of the corners, exactly that many if there are enough; strongest first,
  /// and of equal ones those that came first. `size`: of the image that they lie in.
  void Select(cv::Size size, int wanted, std::vector<Corner>* corners);

 private:
  /// Picks from sorted_ with squares of about 2 `cell_px` to each side, until `limit` are found.
  void Cover(cv::Size size, float cell_px, int limit);

  std::vector<Corner> sorted_;
  std::vector<Corner> picked_;
  std::vector<uint8_t> covered_;
};

/// How many key points each level is to give, of which it has `available`. The shares form a
/// geometric series with ratio 1 / factor; what a level cannot give falls to the others.
std::vector<int> ShareOut(int num_features, double factor, const std::vector<int>& available);

}  // namespace vpslam
