// A change of the map, as the backend publishes it and replicas apply it.
//
// Deltas hold absolute values, so that applying one twice does no harm. `version` counts them; a
// replica applies a delta when base_version is the version it has, and asks for a snapshot else.
// A large change travels in parts that fit a datagram; versions count parts.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/description.h"
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

  static constexpr const char* kWireName = "observation_t";
  static void Describe(auto& v, auto& m) {
    auto& [feature, landmark] = m;
    v("feature", feature, kFeatureIndex);
    v("landmark", landmark, Required());
  }
};

struct KeyframeState {
  KeyframeId id;
  MapId map;
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  /// Culled keyframes stay, without observations, so that poses which hang on them can be expressed
  /// through their parent.
  bool culled = false;
  SE3 cam_from_world;     ///< of a culled keyframe: to be derived from parent and cam_from_parent
  KeyframeId parent;      ///< invalid for the first keyframe of a map
  SE3 cam_from_parent;    ///< fixed at culling
  double unit = 1;        ///< lengths now per lengths when the keyframe was made
  ManhattanId manhattan;  ///< the frame whose axes it sees
  std::vector<FeatureObservation<PointId>> points;
  std::vector<FeatureObservation<LineId>> lines;

  static constexpr const char* kWireName = "keyframe_state_t";
  static void Describe(auto& v, auto& m) {
    auto& [id, map, frame_seq, stamp_us, culled, cam_from_world, parent, cam_from_parent, unit,
           manhattan, points, lines] = m;
    v("id", id, Required());
    v("map_id", map, Required());
    v("frame_seq", frame_seq, kNotNegative);
    v("stamp_us", stamp_us);
    v("culled", culled);
    v("cam_from_world", cam_from_world);
    v("parent", parent);
    v("cam_from_parent", cam_from_parent);
    v("unit", unit, Within{std::numeric_limits<double>::min(), kMaxLength});
    v("manhattan", manhattan);
    v.SizeOf("observations", points);
    v.SizeOf("line_observations", lines);
  }
};

/// What local bundle adjustment moves.
struct PointGeometry {
  PointId id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< in world
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< mean unit vector from point to cameras
  double max_distance = 0;  ///< farthest distance from which level 0 can show it

  static constexpr const char* kWireName = "point_geometry_t";
  static void Describe(auto& v, auto& m) {
    auto& [id, position, normal, max_distance] = m;
    v("id", id, Required());
    v("position", position, kCoordinate);
    v("normal", normal, Within{-1 - kUnitTolerance, 1 + kUnitTolerance});
    v("max_distance", max_distance, kLength);
  }
};

/// What changes rarely.
struct PointAppearance {
  PointId id;
  MapId map;
  KeyframeId reference;
  Descriptor descriptor{};

  static constexpr const char* kWireName = "point_appearance_t";
  static void Describe(auto& v, auto& m) {
    auto& [id, map, reference, descriptor] = m;
    v("id", id, Required());
    v("map_id", map, Required());
    v("reference", reference);
    v("descriptor", descriptor);
  }
};

/// See core/map/map.h.
struct LineState {
  LineId id;
  MapId map;
  KeyframeId reference;
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< in world
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  Descriptor descriptor{};
  ManhattanId manhattan;
  int32_t axis = -1;

  static constexpr const char* kWireName = "map_line_t";
  static void Describe(auto& v, auto& m) {
    auto& [id, map, reference, start, end, descriptor, manhattan, axis] = m;
    v("id", id, Required());
    v("map_id", map, Required());
    v("reference", reference);
    v("start", start, kCoordinate);
    v("end", end, kCoordinate);
    v("descriptor", descriptor);
    v("manhattan", manhattan);
    v("axis", axis, Between{-1, 2});
  }
  std::optional<std::string> Validate() const {
    if (manhattan.IsValid() != (axis >= 0)) return "an axis of no Manhattan frame";
    return std::nullopt;
  }
};

/// The point or line is gone; where it was fused into another, `replacement` is valid.
template <class Id>
struct Tombstone {
  Id id;
  Id replacement;

  static constexpr const char* kWireName = "tombstone_t";
  static void Describe(auto& v, auto& m) {
    auto& [id, replacement] = m;
    v("id", id, Required());
    v("replacement", replacement);
  }
  std::optional<std::string> Validate() const {
    if (id == replacement) return "replaced by itself";
    return std::nullopt;
  }
};

/// A Manhattan frame of a map; see backend/manhattan_frames.h.
struct MapManhattan {
  ManhattanId id;
  MapId map;
  std::optional<Eigen::Quaterniond> world_from_manhattan;  ///< none (any more)

  static constexpr const char* kWireName = "manhattan_frame_t";
  static void Describe(auto& v, auto& m) {
    auto& [id, map, world_from_manhattan] = m;
    v("id", id, Required());
    v("map_id", map, Required());
    v.Optional("exists", world_from_manhattan, Eigen::Quaterniond::Identity(),
               [](auto& visitor, auto& rotation) { visitor("world_from_manhattan", rotation); });
  }
};

/// All of map `merged` belongs to map `into` now.
struct MapMerger {
  MapId merged;
  MapId into;

  static constexpr const char* kWireName = "map_merger_t";
  static void Describe(auto& v, auto& m) {
    auto& [merged, into] = m;
    v("merged", merged, Required());
    v("into", into, Required());
  }
  std::optional<std::string> Validate() const {
    if (merged == into) return "merged into itself";
    return std::nullopt;
  }
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
  // Fused so long ago that nobody should refer to them any more: tombstones that can go.
  std::vector<PointId> forgotten_points;
  std::vector<LineId> forgotten_lines;

  static constexpr const char* kWireName = "map_delta_t";
  static void Describe(auto& v, auto& m) {
    auto& [base_version, version, snapshot, answers, times, erased_maps, merged_maps, keyframes,
           appearances, geometries, tombstones, lines, line_tombstones, manhattan_frames,
           forgotten_points, forgotten_lines] = m;
    v("base_version", base_version);
    v("version", version);
    v("snapshot", snapshot);
    v("answers", answers);
    v("times", times);
    v.Array("num_erased_maps", "erased_maps", erased_maps, Required());
    v.Array("num_merged_maps", "merged_maps", merged_maps);
    v.Array("num_keyframes", "keyframes", keyframes);
    v.Pool("num_observations", "observations", keyframes, &KeyframeState::points);
    v.Array("num_appearances", "appearances", appearances);
    v.Array("num_geometries", "geometries", geometries);
    v.Array("num_tombstones", "tombstones", tombstones);
    v.Pool("num_line_observations", "line_observations", keyframes, &KeyframeState::lines);
    v.Array("num_lines", "lines", lines);
    v.Array("num_line_tombstones", "line_tombstones", line_tombstones);
    v.Array("num_manhattan_frames", "manhattan_frames", manhattan_frames);
    v.Array("num_forgotten_points", "forgotten_points", forgotten_points, Required());
    v.Array("num_forgotten_lines", "forgotten_lines", forgotten_lines, Required());
  }
  std::optional<std::string> Validate() const {
    // Within a snapshot versions run downwards from 0.
    if (version < base_version && base_version > 0) return "versions out of order";
    return std::nullopt;
  }
};

}  // namespace vpslam
