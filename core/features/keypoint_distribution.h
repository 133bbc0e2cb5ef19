// Choice of corners: strong ones, for they are found again in the next image, but everywhere.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/types.hpp>

#include "core/features/corner_detector.h"

namespace vpslam {

/// With the strongest corners alone, half again as many are matched between images as with an even
/// spread, but they cover half of the image only, and drift grows. Lengths are in units of the fair
/// spacing sqrt(area / number wanted).
struct DistributionOptions {
  double min_spacing = 0.4;  ///< half the side of the square that a corner keeps free of others
  double cell = 1.22;        ///< side of the cells whose best corner is kept before all others

  template <class V>
  void Visit(V& v) {
    v("min_spacing", min_spacing);
    v("cell", cell);
  }
  std::optional<std::string> Validate() const;
};

/// From strong to weak, each corner covers a square around it, as in "suppression via square
/// covering" of [Bailo18, "Efficient adaptive non-maximal suppression algorithms for homogeneous
/// spatial keypoint distribution", Pattern Recognition Letters 106], but a small one. Kept are: the
/// best uncovered corner of each cell; then other uncovered ones; then covered ones.
class KeypointDistribution {
 public:
  explicit KeypointDistribution(const DistributionOptions& options = {}) : options_(options) {}

  /// Keeps `wanted` of the corners, or all if there are fewer. `size`: of the image they lie in.
  void Select(cv::Size size, int wanted, std::vector<Corner>* corners);

 private:
  DistributionOptions options_;
  std::vector<Corner> sorted_, uncovered_, covered_;
  std::vector<uint8_t> cover_mask_, cell_taken_;
};

/// How many key points each level is to give, of which it has `available`. The shares form a
/// geometric series with ratio 1 / factor; what a level cannot give falls to the others.
std::vector<int> ShareOut(int num_features, double factor, const std::vector<int>& available);

}  // namespace vpslam
