// What vpdetector says of one image: line segments, their descriptors, and vanishing points.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/features/features.h"

namespace vpslam {

/// A segment in undistorted pixels, oriented as the detector found it.
struct LineSegment {
  Eigen::Vector2f start_px = Eigen::Vector2f::Zero();
  Eigen::Vector2f end_px = Eigen::Vector2f::Zero();
  Descriptor descriptor{};
  bool has_descriptor = false;
  /// Index into LineSet::vanishing_points of the VP it points to; -1 for none.
  int32_t label = -1;
};

struct VanishingPoint {
  Eigen::Vector3d direction_in_cam = Eigen::Vector3d::UnitZ();  ///< unit; sign carries no meaning
  Eigen::Matrix2d covariance_rad2 = Eigen::Matrix2d::Zero();  ///< in the tangent plane at direction
  int32_t support = 0;                                        ///< number of distinct infinite lines
};

/// How many Manhattan directions the image itself carries. With `kTwo` the third axis of the
/// rotation is the cross product of two that are seen.
enum class ManhattanState : int32_t { kNone = 0, kTwo = 2, kThree = 3 };

struct LineSet {
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  std::vector<LineSegment> lines;
  /// The first three are the Manhattan axes where manhattan != kNone, then further directions.
  std::vector<VanishingPoint> vanishing_points;
  ManhattanState manhattan = ManhattanState::kNone;
  Eigen::Quaterniond cam_from_manhattan = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d covariance_rad2 = Eigen::Matrix3d::Zero();  ///< of the left perturbation
  double lines_ms = 0, descriptors_ms = 0, vps_ms = 0;
};

}  // namespace vpslam
