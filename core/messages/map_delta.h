// A change of the map, as the backend publishes it and replicas apply it.
//
// Deltas hold absolute values, so that applying one twice does no harm. `version` counts them; a
// replica applies a delta when base_version is the version it has, and asks for a snapshot else.
// A large change travels in parts that fit a datagram; versions count parts.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/ids.h"
#include "core/features/features.h"
#include "core/geometry/se3.h"
#include "core/messages/stages.h"

namespace vpslam {

/// A keyframe's feature or line segment, by index, observes a map point or line.
template <class Id>
struct FeatureObservation {
  int32_t feature = 0;
  Id landmark;
};

struct KeyframeState {
  KeyframeId id;
  MapId map;
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  /// Culled keyframes stay, without observations, so that poses which hang on them can be expressed
  /// through their parent.
  bool culled = false;
  SE3 cam_from_world;   ///< of a culled keyframe: to be derived from parent and cam_from_parent
  KeyframeId parent;    ///< invalid for the first keyframe of a map
  SE3 cam_from_parent;  ///< fixed at culling
  double unit = 1;      ///< lengths now per lengths when the keyframe was made
  std::vector<FeatureObservation<PointId>> points;
  std::vector<FeatureObservation<LineId>> lines;
};

/// What local bundle adjustment moves.
struct PointGeometry {
  PointId id;
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< in world
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();    ///< mean unit vector from point to cameras
  float max_distance = 0;  ///< farthest distance from which level 0 can show it
};

/// What changes rarely.
struct PointAppearance {
  PointId id;
  MapId map;
  KeyframeId reference;
  Descriptor descriptor{};
};

/// See core/map/map.h.
struct LineState {
  LineId id;
  MapId map;
  KeyframeId reference;
  Eigen::Vector3f start = Eigen::Vector3f::Zero();  ///< in world
  Eigen::Vector3f end = Eigen::Vector3f::Zero();
  Descriptor descriptor{};
  int32_t axis = -1;
};

/// The point or line is gone; where it was fused into another, `replacement` is valid.
template <class Id>
struct Tombstone {
  Id id;
  Id replacement;
};

/// The Manhattan frame of a map; see backend/manhattan_frame.h.
struct MapManhattan {
  MapId map;
  std::optional<Eigen::Quaterniond> world_from_manhattan;  ///< none (any more)
};

/// All of map `from` belongs to map `into` now.
struct MapMerger {
  MapId from;
  MapId into;
};

struct MapDelta {
  int64_t base_version = 0;
  int64_t version = 0;
  bool snapshot = false;  ///< first part of a snapshot: the replica clears itself first
  /// Set on the last part of the answer to a keyframe: everything it caused is in the map now.
  KeyframeId answers;
  MappingTimes times;  ///< of that keyframe
  std::vector<MapId> erased_maps;
  std::vector<MapMerger> merged_maps;
  std::vector<KeyframeState> keyframes;
  std::vector<PointAppearance> appearances;  ///< of new and of changed points
  std::vector<PointGeometry> geometries;
  std::vector<Tombstone<PointId>> tombstones;
  std::vector<LineState> lines;  ///< new and changed
  std::vector<Tombstone<LineId>> line_tombstones;
  std::vector<MapManhattan> manhattan_frames;
};

}  // namespace vpslam
