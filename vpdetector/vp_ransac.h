// Manhattan directions from three lines at a time: "2-1-0". Two lines of one axis meet in its
// vanishing direction d0 = s1 x s2; one line of a second axis gives d1 = d0 x s3, the direction
// that lies both on its great circle and at right angles to d0; the third follows. E.g. [Mirzaei11]
// F. Mirzaei, S. Roumeliotis, "Optimal estimation of vanishing points in a Manhattan world", ICCV
// 2011.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "vpdetector/vp_lines.h"
#include "vpdetector/vp_refine.h"

namespace vpslam {

struct VpRansacOptions {
  int num_hypotheses = 400;
  /// Hypotheses that are refined before the best is chosen.
  int num_refined = 4;
  /// Those differ from each other by at least this.
  double min_difference_deg = 2.0;
  /// Only as many lines are looked at, the longest.
  int max_lines = 400;
  uint64_t seed = 1;

  template <class V>
  void Visit(V& v) {
    v("num_hypotheses", num_hypotheses);
    v("num_refined", num_refined);
    v("min_difference_deg", min_difference_deg);
    v("max_lines", max_lines);
    v("seed", seed);
  }
  std::optional<std::string> Validate() const;
};

/// nullopt with fewer than three lines, or if all of them are one.
std::optional<ManhattanFit> FindManhattan(const std::vector<VpLine>& lines, const VpModel& model,
                                          const VpRansacOptions& options);

}  // namespace vpslam
