// Vanishing points of a set of segments: the Manhattan axes, how much of them the image really
// carries, further directions, and a label for every segment.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/features/line_set.h"
#include "core/geometry/camera.h"
#include "vpdetector/edge_fit.h"
#include "vpdetector/two_line_grid.h"
#include "vpdetector/vp_ransac.h"
#include "vpdetector/vp_refine.h"

namespace vpslam {

enum class VpMethod {
  kThreeLine,       ///< 2-1-0 hypotheses and refinement on SO(3)
  kTwoLineGrid,     ///< the paper's: polar grid, labels, one least squares on SO(3) over them
  kTwoLineGridRaw,  ///< the best hypothesis of the grid as it is
};

/// "three_line", "two_line_grid", "two_line_grid_raw"; nullopt for anything else.
std::optional<VpMethod> VpMethodFromName(const std::string& name);
const char* Name(VpMethod method);

struct VpOptions {
  VpMethod method = VpMethod::kThreeLine;
  VpModel model;
  VpRansacOptions ransac;
  TwoLineGridOptions grid;
  /// Shorter segments are not looked at: their direction is too vague.
  double min_length_px = 30.0;
  /// Segments whose ends lie this close to the line through a longer one count as one witness.
  double same_line_px = 3.0;
  /// An axis is seen if at least so many distinct lines support it ...
  int min_support = 3;
  /// ... and among random lines as many would be expected to do so less often than this, counted
  /// over all directions that could have been tried (a-contrario, as [vonGioi10] does for
  /// segments).
  double max_false_alarms = 0.01;
  /// Directions beside the three that are reported at most.
  int max_further = 3;
  /// Distinct lines that one of them needs at least.
  int min_further_support = 5;
  /// They lie at least this far from every other: closer ones are an axis again, of lines that miss
  /// its gate.
  double min_separation_deg = 10.0;

  template <class V>
  void Visit(V& v) {
    v("method", method);
    v("model", model);
    v("ransac", ransac);
    v("grid", grid);
    v("min_length_px", min_length_px);
    v("same_line_px", same_line_px);
    v("min_support", min_support);
    v("max_false_alarms", max_false_alarms);
    v("max_further", max_further);
    v("min_further_support", min_further_support);
    v("min_separation_deg", min_separation_deg);
  }
  std::optional<std::string> Validate() const;
};

struct VpEstimate {
  /// Always three directions, the best guess also where `state` says that they are none. Columns in
  /// the order and with the signs that come closest to the axes of the camera.
  Eigen::Matrix3d cam_from_manhattan = Eigen::Matrix3d::Identity();
  Eigen::Matrix3d covariance_rad2 = Eigen::Matrix3d::Zero();  ///< of the left perturbation
  ManhattanState state = ManhattanState::kNone;
  std::vector<VanishingPoint> vanishing_points;  ///< as in LineSet
  std::vector<int32_t> labels;                   ///< per segment, as in LineSegment
};

/// Depends on its arguments alone.
VpEstimate EstimateVanishingPoints(const std::vector<EdgeSegment>& segments, const Camera& camera,
                                   const VpOptions& options);

}  // namespace vpslam
