// What vpdetector says of one image: line segments, their descriptors, and vanishing points.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/stopwatch.h"
#include "core/features/features.h"

namespace vpslam {

/// A segment in undistorted pixels. Looking from start to end, with y down, its brighter side is on
/// the right: so the same edge has the same orientation, and comparable descriptors, in every view.
struct LineSegment {
  Eigen::Vector2f start_px = Eigen::Vector2f::Zero();
  Eigen::Vector2f end_px = Eigen::Vector2f::Zero();
  /// Standard deviation of either end point across the line. Along the line nothing is promised:
  /// ends are where the detector lost the edge.
  float sigma_px = 0;
  Descriptor descriptor{};      ///< LBD; zeros without has_descriptor
  bool has_descriptor = false;  ///< true for the longest lines only
  /// Index into LineSet::vanishing_points of the VP it points to; -1 for none.
  int32_t label = -1;
};

struct VanishingPoint {
  Eigen::Vector3d direction_in_cam = Eigen::Vector3d::UnitZ();  ///< unit; sign carries no meaning
  /// In the plane of TangentBasis(direction_in_cam), see core/geometry/sphere.h.
  Eigen::Matrix2d covariance_rad2 = Eigen::Matrix2d::Zero();
  int32_t support = 0;  ///< number of distinct infinite lines
};

/// How many Manhattan directions the image itself carries. With `kTwo` the third axis of the
/// rotation is the cross product of two that are seen; its support is 0 and no line has its label.
enum class ManhattanState : int32_t { kNone = 0, kTwo = 2, kThree = 3 };

struct LineSet {
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  std::vector<LineSegment> lines;  ///< longest first
  /// The first three are the Manhattan axes where manhattan != kNone, the columns of
  /// cam_from_manhattan; then further directions, the best supported ones first.
  std::vector<VanishingPoint> vanishing_points;
  ManhattanState manhattan = ManhattanState::kNone;
  /// Of the 24 rotations that name the same axes the one nearest to the identity: which axis of the
  /// world is which, and its sign, is for the frontend to follow. Identity where kNone.
  Eigen::Quaterniond cam_from_manhattan = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d covariance_rad2 = Eigen::Matrix3d::Zero();  ///< of the left perturbation
  double lines_ms = kNotRun, descriptors_ms = kNotRun, vps_ms = kNotRun;
};

}  // namespace vpslam
