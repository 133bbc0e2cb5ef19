// A frame that the frontend hands to the backend as a keyframe.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

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
};

/// A point of a new map, as two-view initialisation triangulated it.
struct InitialPoint {
  int32_t feature_in_first = 0;
  int32_t feature_in_second = 0;
  Eigen::Vector3d position_in_world = Eigen::Vector3d::Zero();
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
  SE3 cam_from_world;
  KeyframeId reference;  ///< keyframe it was tracked against; the parent to be
  Features features;
  std::vector<PointId> points;  ///< per feature: the map point it observes, invalid for none
  std::vector<PointSighting> sightings;
  std::vector<InitialPoint> initial_points;
  LineSet lines;
  std::vector<LineId> map_lines;  ///< per line: the map line it observes, invalid for none
  MapSeam seam;
};

}  // namespace vpslam
