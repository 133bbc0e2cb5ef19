// A frame that the frontend hands to the backend as a keyframe.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/base/description.h"
#include "core/base/ids.h"
#include "core/features/features.h"
#include "core/features/line_set.h"
#include "core/geometry/se3.h"
#include "core/messages/map_delta.h"

namespace vpslam {

enum class KeyframeRole : int32_t {
  kRegular = 0,
  kMapFirst = 1,   ///< first of the two views that start a map; nothing happens until the second
  kMapSecond = 2,  ///< second of them; carries `initial_points`
};

/// How often a point was predicted visible and really found, since the last proposal.
struct PointSighting {
  PointId point;
  int32_t visible = 0;
  int32_t found = 0;

  static constexpr const char* kWireName = "sighting_t";
  static void Describe(auto& v, auto& m) {
    auto& [point, visible, found] = m;
    v("point", point, Required());
    v("visible", visible, kNotNegative);
    v("found", found, kNotNegative);
  }
};

/// A point of a new map, as two-view initialisation triangulated it.
struct InitialPoint {
  int32_t feature_in_first = 0;
  int32_t feature_in_second = 0;
  Eigen::Vector3d position_in_world = Eigen::Vector3d::Zero();

  static constexpr const char* kWireName = "initial_point_t";
  static void Describe(auto& v, auto& m) {
    auto& [feature_in_first, feature_in_second, position_in_world] = m;
    v("feature_in_first", feature_in_first, kFeatureIndex);
    v("feature_in_second", feature_in_second, kFeatureIndex);
    v("position", position_in_world, kCoordinate);
  }
};

/// The frame was found in another map as well: the two show one place.
struct MapSeam {
  MapId map;                                        ///< the other; invalid: there is no seam
  SE3 cam_from_world;                               ///< in the other's coordinates
  std::vector<FeatureObservation<PointId>> points;  ///< of the other
};

struct KeyframeProposal {
  KeyframeId id;
  KeyframeRole role = KeyframeRole::kRegular;
  MapId map;
  /// This map failed its probation: erase it. Invalid if there is none.
  MapId discarded_map;
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  int64_t map_version = 0;  ///< of the replica that it was tracked in
  SE3 cam_from_world;
  KeyframeId reference;  ///< keyframe it was tracked against; the parent to be
  Features features;
  std::vector<PointId> points;  ///< per feature: the map point it observes, invalid for none
  std::vector<PointSighting> sightings;
  std::vector<InitialPoint> initial_points;
  LineSet lines;
  std::vector<LineId> map_lines;  ///< per line: the map line it observes, invalid for none
  MapSeam seam;

  static constexpr const char* kWireName = "keyframe_t";
  static void Describe(auto& v, auto& m) {
    auto& [id, role, map, discarded_map, frame_seq, stamp_us, map_version, cam_from_world,
           reference, features, points, sightings, initial_points, lines, map_lines, seam] = m;
    using enum KeyframeRole;
    v("id", id, Required());
    v("role", role, OneOf<kRegular, kMapFirst, kMapSecond>());
    v("map_id", map, Required());
    v("discarded_map", discarded_map);
    v("frame_seq", frame_seq, kNotNegative);
    v("stamp_us", stamp_us);
    v("map_version", map_version);
    v("cam_from_world", cam_from_world);
    v("reference", reference);
    v.Array("num_features", "keypoints", features.keypoints);
    v.Array("num_features", "descriptors", features.descriptors);
    v.Array("num_features", "points", points);
    v.Array("num_sightings", "sightings", sightings);
    v.Array("num_initial_points", "initial_points", initial_points);
    v.Nested("line_set", lines, LineSetSummary());
    v.Array("num_lines", "lines", lines.lines);
    v.Array("num_lines", "map_lines", map_lines);
    v.Array("num_vanishing_points", "vanishing_points", lines.vanishing_points);
    v("seam_map", seam.map);
    v("seam_cam_from_world", seam.cam_from_world);
    v.Array("num_seam_points", "seam_points", seam.points);
  }
  std::optional<std::string> Validate() const {
    if (role != KeyframeRole::kMapSecond && !initial_points.empty()) {
      return "initial points without the role that they belong to";
    }
    for (const InitialPoint& p : initial_points) {
      if (p.feature_in_second >= features.size()) return "an initial point of no feature";
    }
    for (const FeatureObservation<PointId>& p : seam.points) {
      if (p.feature >= features.size()) return "a seam point of no feature";
    }
    return lines.Validate();
  }
};

}  // namespace vpslam
