// What vpdetector says of one image: line segments, their descriptors, and vanishing points.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/description.h"
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

  static constexpr const char* kWireName = "line_segment_t";
  static void Describe(auto& v, auto& m) {
    auto& [start_px, end_px, sigma_px, descriptor, has_descriptor, label] = m;
    v("start_px", start_px, kPixel);
    v("end_px", end_px, kPixel);
    v("sigma_px", sigma_px, Within{0, kPixel.high});
    v("has_descriptor", has_descriptor);
    v("descriptor", descriptor);
    v("label", label, kIndexOrNone);
  }
};

struct VanishingPoint {
  Eigen::Vector3d direction_in_cam = Eigen::Vector3d::UnitZ();  ///< unit; sign carries no meaning
  /// In the plane of TangentBasis(direction_in_cam), see core/geometry/sphere.h.
  Eigen::Matrix2d covariance_rad2 = Eigen::Matrix2d::Zero();
  int32_t support = 0;  ///< number of distinct infinite lines

  static constexpr const char* kWireName = "vanishing_point_t";
  static void Describe(auto& v, auto& m) {
    auto& [direction_in_cam, covariance_rad2, support] = m;
    v("direction_in_cam", direction_in_cam, UnitLength());
    v("covariance_rad2", covariance_rad2);
    v("support", support, kNotNegative);
  }
};

/// How many Manhattan directions the image itself carries. With `kTwo` the third axis of the
/// rotation is the cross product of two that are seen; its support is 0 and no line has its label.
enum class ManhattanState : int32_t { kNone = 0, kTwo = 2, kThree = 3 };

/// Describes what is said of the lines of one image, but for the lines themselves.
struct LineSetSummary {
  static constexpr const char* kWireName = "line_set_t";
  static void Visit(auto& v, auto& m) {
    auto& [frame_seq, stamp_us, lines, vanishing_points, manhattan, cam_from_manhattan,
           covariance_rad2, lines_ms, descriptors_ms, vps_ms] = m;
    using enum ManhattanState;
    v("frame_seq", frame_seq, kNotNegative);
    v("stamp_us", stamp_us);
    v("manhattan", manhattan, OneOf<kNone, kTwo, kThree>());
    v("cam_from_manhattan", cam_from_manhattan);
    v("covariance_rad2", covariance_rad2);
    v("lines_ms", lines_ms, Duration());
    v("descriptors_ms", descriptors_ms, Duration());
    v("vps_ms", vps_ms, Duration());
  }
};

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

  static constexpr const char* kWireName = "lines_t";
  static void Describe(auto& v, auto& m) {
    v.Nested("set", m, LineSetSummary());
    v.Array("num_lines", "lines", m.lines);
    v.Array("num_vanishing_points", "vanishing_points", m.vanishing_points);
  }
  std::optional<std::string> Validate() const {
    if (vanishing_points.size() < static_cast<std::size_t>(manhattan)) {
      return "fewer vanishing points than Manhattan axes";
    }
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (lines[i].label >= static_cast<int64_t>(vanishing_points.size())) {
        return "lines[" + std::to_string(i) + "].label: there is no such vanishing point";
      }
    }
    return std::nullopt;
  }
};

}  // namespace vpslam
