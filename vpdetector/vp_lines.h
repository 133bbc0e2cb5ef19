// Segments as vanishing points see them: great circles with a measure of how well they are known.
//
// A segment and the camera centre span a plane with unit normal s. The segment points to the
// vanishing direction d if s . d = 0. The residual s . d has two independent sources of error:
// - the end points' errors across the segment, which turn s; how much of that shows depends on
//   where d lies (a vanishing point beyond the one end magnifies the error of the other);
// - the world: edges that are meant to be parallel are so only to a fraction of a degree. Without
//   it, long segments would be believed without limit.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/geometry/camera.h"

namespace vpslam {

struct VpLine {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< s, unit; its sign carries no meaning
  /// normal . d changes by noise_a . d (noise_b . d) if the start (end) point moves across the
  /// segment by one standard deviation.
  Eigen::Vector3d noise_a = Eigen::Vector3d::Zero();
  Eigen::Vector3d noise_b = Eigen::Vector3d::Zero();
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();      ///< on the plane z = 1
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< on that plane, unit
  double length_px = 0;
  /// 1, or less for one of several segments on one line, whose errors are not independent.
  double weight = 1;
  int32_t source = -1;  ///< index of the segment it came from

  /// Variance of normal . d without the error of the world.
  double EndPointVariance(const Eigen::Vector3d& d) const {
    const double a = noise_a.dot(d), b = noise_b.dot(d);
    return a * a + b * b;
  }
  /// The same where d is not known yet: on average over the line's great circle.
  double MeanEndPointVariance() const {
    return 0.5 * (noise_a.squaredNorm() + noise_b.squaredNorm());
  }
};

/// Segment in undistorted px; `sigma_px` is the standard deviation of an end point across it.
/// nullopt if the segment is shorter than `min_length_px`.
std::optional<VpLine> MakeVpLine(const Camera& camera, const Eigen::Vector2d& start_px,
                                 const Eigen::Vector2d& end_px, double sigma_px,
                                 double min_length_px);

/// For each segment the index of the longest one on the same infinite line: both ends of the
/// shorter within `distance_px` of it. Support counts those, since ten fragments of one edge are no
/// ten witnesses.
std::vector<int32_t> GroupByInfiniteLine(const std::vector<Eigen::Vector2d>& starts_px,
                                         const std::vector<Eigen::Vector2d>& ends_px,
                                         double distance_px);

}  // namespace vpslam
