// The map: keyframes, points, lines, and who observes whom. The backend owns one and changes it;
// frontend and recorder hold replicas that follow by deltas.
//
// Invariants: observations are kept on both sides and agree; lists are ordered by id, so that no
// result depends on the order of a hash table; ids of erased points forward to what replaced them.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/base/ids.h"
#include "core/features/features.h"
#include "core/geometry/se3.h"
#include "core/geometry/sim3.h"
#include "core/messages/map_delta.h"

namespace vpslam {

struct Observation {
  KeyframeId keyframe;
  int32_t feature = 0;  ///< of the keyframe's features, or of its line segments
};

/// What points and lines have in common.
template <class Id>
struct Landmark {
  Id id;
  MapId map;
  KeyframeId reference;                   ///< the keyframe that created it
  std::vector<Observation> observations;  ///< by ascending keyframe
  bool erased = false;
  Id replacement;  ///< of an erased one that was fused
};

struct MapPoint : Landmark<PointId> {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< in world
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< mean unit vector from point to cameras
  double max_distance = 0;  ///< farthest distance from which level 0 can show it
  Descriptor descriptor{};
};

/// An infinite line, and how much of it was seen. From start to end it runs as its segments do, see
/// core/features/line_set.h.
struct MapLine : Landmark<LineId> {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< in world
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  Descriptor descriptor{};
  int32_t axis = -1;  ///< of the map's Manhattan frame, to which it is parallel; -1 for none

  Eigen::Vector3d Direction() const { return (end - start).normalized(); }
};

struct Keyframe {
  KeyframeId id;
  MapId map;
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  bool culled = false;
  SE3 cam_from_world;  ///< of a culled one: ask Map::CamFromWorld
  KeyframeId parent;
  SE3 cam_from_parent;  ///< of a culled one
  /// Lengths now per lengths when the keyframe was made: maps that are merged change their unit.
  double unit = 1;
  std::vector<PointId> points;  ///< per feature; invalid where it observes none
  std::vector<LineId> lines;    ///< per line segment; invalid where it observes none

  Eigen::Vector3d Center() const { return cam_from_world.Center(); }
};

/// What changed since the last delta; filled by the owner's Map.
struct MapChanges {
  std::set<MapId> erased_maps;
  std::set<MapId> merged_maps;  ///< that have become part of another
  std::set<KeyframeId> keyframes;
  std::set<PointId> appearances;
  std::set<PointId> geometries;
  std::set<PointId> tombstones;
  std::set<LineId> lines;
  std::set<LineId> line_tombstones;
  std::set<MapId> manhattan_frames;
};

class Map {
 public:
  // ---- Reading ----

  /// nullptr if it never existed, or is erased or culled.
  const MapPoint* Find(PointId id) const;
  const MapLine* Find(LineId id) const;
  const Keyframe* Find(KeyframeId id) const;
  /// The living point or line that `id` has become; invalid if there is none.
  PointId Resolve(PointId id) const;
  LineId Resolve(LineId id) const;
  /// Also of culled keyframes, through their parents; nullptr-like `false` if unknown.
  bool CamFromWorld(KeyframeId id, SE3* cam_from_world) const;
  /// Where a camera stands that was placed relative to a keyframe, and what to keep of one to be
  /// placed later. `cam_from_reference` has the unit of length that the reference was made in, so
  /// it outlives corrections and mergers of maps. False if the keyframe is unknown.
  bool Place(KeyframeId reference, const SE3& cam_from_reference, SE3* cam_from_world) const;
  bool Hang(KeyframeId reference, const SE3& cam_from_world, SE3* cam_from_reference) const;
  /// The keyframe itself or, if it was culled, the nearest ancestor that was not; invalid if none.
  KeyframeId LivingAncestor(KeyframeId id) const;

  /// Keyframes that share at least min_shared points and lines with `id`, most first, ties by id.
  std::vector<std::pair<KeyframeId, int>> Covisible(KeyframeId id, int min_shared) const;
  /// All ids ever used are below these.
  int32_t keyframe_end() const { return static_cast<int32_t>(keyframes_.size()); }
  int32_t point_end() const { return static_cast<int32_t>(points_.size()); }
  int32_t line_end() const { return static_cast<int32_t>(lines_.size()); }
  /// Also culled ones; nullptr if unknown. For results.
  const Keyframe* FindEvenCulled(KeyframeId id) const;
  /// The map that `id` has become part of; itself if it has not.
  MapId Resolve(MapId id) const;
  /// All ids of maps ever used are below this.
  int32_t map_end() const;
  /// How many maps have become part of others.
  int num_merged() const { return static_cast<int>(merged_maps_.size()); }
  /// Maps that have keyframes, ascending.
  std::vector<MapId> Maps() const;
  int NumKeyframes(MapId map) const;
  int NumPoints(MapId map) const;
  int NumLines(MapId map) const;
  /// None if the map has no Manhattan frame.
  std::optional<Eigen::Quaterniond> WorldFromManhattan(MapId map) const;
  int64_t version() const { return version_; }

  // ---- Changing, by the owner ----

  void Insert(const Keyframe& keyframe);
  PointId CreatePoint(MapId map, KeyframeId reference, const Eigen::Vector3d& position);
  LineId CreateLine(MapId map, KeyframeId reference, const Eigen::Vector3d& start,
                    const Eigen::Vector3d& end);
  void Observe(KeyframeId keyframe, int32_t feature, PointId point);
  void Observe(KeyframeId keyframe, int32_t segment, LineId line);
  /// Erases the point or line too when fewer than two observations remain.
  void Unobserve(KeyframeId keyframe, PointId point);
  void Unobserve(KeyframeId keyframe, LineId line);
  void Erase(PointId point);
  void Erase(LineId line);
  /// Moves observations of `from` to `to` where `to` has none in that keyframe, and erases `from`.
  void Fuse(PointId from, PointId to);
  void Fuse(LineId from, LineId to);
  /// The keyframe keeps its place in the tree: parent and pose relative to it. Its children go to
  /// its parent. The first keyframe of a map cannot be culled.
  void Cull(KeyframeId keyframe);
  void EraseMap(MapId map);
  /// Brings all that `map` holds into other coordinates: x_new = new_from_old * x_old.
  void Transform(MapId map, const Sim3& new_from_old);
  /// What `from` holds belongs to `into` from now on. Their coordinates must agree already.
  void Absorb(MapId from, MapId into);
  void SetPose(KeyframeId keyframe, const SE3& cam_from_world);
  void SetParent(KeyframeId keyframe, KeyframeId parent);
  void SetPosition(PointId point, const Eigen::Vector3d& position);
  void SetView(PointId point, const Eigen::Vector3d& normal, double max_distance);
  void SetDescriptor(PointId point, const Descriptor& descriptor);
  void SetEnds(LineId line, const Eigen::Vector3d& start, const Eigen::Vector3d& end);
  void SetDescriptor(LineId line, const Descriptor& descriptor);
  void SetAxis(LineId line, int32_t axis);
  /// nullopt: the map has no Manhattan frame any more, and its lines have no axis. A frame that is
  /// found later may name its axes otherwise.
  void SetManhattan(MapId map, const std::optional<Eigen::Quaterniond>& world_from_manhattan);

  // ---- Replication ----

  /// Everything that changed since the last call, in parts of a bounded size; each part has its own
  /// version. `answers` and `times` go into the last part. At least one part.
  std::vector<MapDelta> TakeDeltas(KeyframeId answers, const MappingTimes& times);
  /// The whole map at the present version, in parts; the first clears a replica.
  std::vector<MapDelta> Snapshot() const;
  /// False, and nothing done, if the delta does not continue the version at hand.
  bool Apply(const MapDelta& delta);

 private:
  Keyframe& Mutable(KeyframeId id);
  MapPoint& Mutable(PointId id);
  MapLine& Mutable(LineId id);
  KeyframeState State(const Keyframe& keyframe) const;
  std::vector<MapDelta> Parts(const MapChanges& changes) const;
  // The same for points and lines.
  static std::vector<PointId>& Slots(Keyframe& keyframe, PointId) { return keyframe.points; }
  static std::vector<LineId>& Slots(Keyframe& keyframe, LineId) { return keyframe.lines; }
  template <class Id>
  void ObserveAny(KeyframeId keyframe, int32_t feature, Id id);
  template <class Id>
  void UnobserveAny(KeyframeId keyframe, Id id);
  template <class Id>
  void EraseAny(Id id);
  template <class Id>
  void FuseAny(Id from, Id to);
  template <class Landmark>
  void RemoveObservation(Landmark& landmark, KeyframeId keyframe);
  template <class Id>
  void ApplyObservations(KeyframeId keyframe, const std::vector<FeatureObservation<Id>>& now);
  template <class Id>
  void ApplyTombstone(const Tombstone<Id>& tombstone);
  void NoteErasure(PointId id);
  void NoteErasure(LineId id);

  std::deque<Keyframe> keyframes_;                        ///< by id; id invalid where unknown
  std::deque<MapPoint> points_;                           ///< by id; id invalid where unknown
  std::deque<MapLine> lines_;                             ///< by id; id invalid where unknown
  std::map<MapId, Eigen::Quaterniond> manhattan_frames_;  ///< world_from_manhattan
  std::set<MapId> erased_maps_;
  std::map<MapId, MapId> merged_maps_;  ///< into which
  MapChanges changes_;
  int64_t version_ = 0;
};

}  // namespace vpslam
