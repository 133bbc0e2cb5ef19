// The vanishing points of the paper: 2-line exhaustive search on a polar grid.
// [Lu17] X. Lu, J. Yao, H. Li, Y. Liu, X. Zhang, "2-Line Exhaustive Searching for Real-Time
// Vanishing Point Estimation in Manhattan World", WACV 2017.
//
// 1. Every pair of lines votes for the direction in which it meets, in a grid of 90 x 360 cells of
//    latitude (angle from the optical axis) and longitude, by sqrt(l1 l2) (sin 2 theta + 0.2) with
//    theta the angle between the two in the image.
// 2. The grid is smoothed: each cell plus the mean of its 3 x 3 neighbourhood.
// 3. Random pairs of lines give first directions; for each of them the second turns round it in
//    steps of a degree, the third follows. The best sum of three cells wins.
// 4. Lines within 6 degrees of the direction from their middle to a vanishing point belong to it.
//
// Repaired, as it does not change the method:
// - the grid has no border: over the equator and over the pole lies the antipode, which is the same
//   vanishing point, and longitude wraps around;
// - the weight stays at its maximum beyond 45 degrees, where sin 2 theta would fall and then turn
//   negative: lines that meet at a right angle inside the image fix their intersection best;
// - turning the second direction by 90 degrees exchanges it with the third, so 90 steps of a degree
//   say all that 360 do.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "vpdetector/vp_lines.h"

namespace vpslam {

struct TwoLineGridOptions {
  /// Pairs of lines that give a first direction: ln(1 - p) / ln(1 - (1 - e)^2 / 3) with p = 0.9999
  /// and a share e = 0.5 of outliers.
  int num_first_directions = 105;
  /// Angle between a line and the direction to the vanishing point that it belongs to.
  double label_deg = 6.0;
  /// Only as many lines vote, the longest.
  int max_lines = 400;
  uint64_t seed = 1;

  template <class V>
  void Visit(V& v) {
    v("num_first_directions", num_first_directions);
    v("label_deg", label_deg);
    v("max_lines", max_lines);
    v("seed", seed);
  }
  std::optional<std::string> Validate() const;
};

struct TwoLineGridResult {
  Eigen::Matrix3d cam_from_manhattan = Eigen::Matrix3d::Identity();
  std::vector<int32_t> labels;  ///< per line 0 to 2, or -1
  double score = 0;             ///< sum of the three cells
};

/// nullopt with fewer than three lines, or if no two of them meet.
std::optional<TwoLineGridResult> SearchTwoLineGrid(const std::vector<VpLine>& lines,
                                                   const TwoLineGridOptions& options);

}  // namespace vpslam
