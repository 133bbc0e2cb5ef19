// The map as its owner has it: every change is noted in a journal, from which deltas for the
// replicas are made, so that none can be forgotten.
//
// All that is changed must exist: an id that does not is an UnknownIdError.
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/geometry/sim3.h"
#include "core/map/map.h"
#include "core/messages/map_delta.h"

namespace vpslam {

class OwnedMap : public Map {
 public:
  /// `session`: of the ids that are given here; one that never was before, see latest_session().
  explicit OwnedMap(int32_t session = 0) : session_(session) {}
  /// Goes on with what another owner made. `session`: above those of all landmarks in it.
  OwnedMap(const Map& map, int32_t session);

  /// With the landmarks that it observes, as far as they live.
  void Insert(const Keyframe& keyframe);
  PointId CreatePoint(MapId map, KeyframeId reference, const Eigen::Vector3d& position);
  LineId CreateLine(MapId map, KeyframeId reference, const Eigen::Vector3d& start,
                    const Eigen::Vector3d& end);
  void Observe(KeyframeId keyframe, int32_t feature, PointId point);
  void Observe(KeyframeId keyframe, int32_t segment, LineId line);
  /// Erases the point or line too when fewer than two observations remain.
  void Unobserve(KeyframeId keyframe, PointId point);
  void Unobserve(KeyframeId keyframe, LineId line);
  void Erase(PointId point) { EraseAny(point, {}); }
  void Erase(LineId line) { EraseAny(line, {}); }
  /// Moves observations of `from` to `to` where `to` has none in that keyframe, and erases `from`.
  void Fuse(PointId from, PointId to) { FuseAny(from, to); }
  void Fuse(LineId from, LineId to) { FuseAny(from, to); }
  /// The keyframe keeps its place in the tree: parent and pose relative to it. Its children go to
  /// its parent. The first keyframe of a map cannot be culled. What it saw is let go.
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

  ManhattanId CreateManhattan(MapId map, const Eigen::Quaterniond& world_from_manhattan);
  void SetManhattan(ManhattanId id, const Eigen::Quaterniond& world_from_manhattan);
  /// Its lines have no axis afterwards, its keyframes no Manhattan frame.
  void EraseManhattan(ManhattanId id);
  /// The line is parallel to that axis (0 to 2) of the frame; an invalid id: to none.
  void SetAxis(LineId line, ManhattanId manhattan, int32_t axis);
  /// The keyframe sees the axes of that frame; an invalid id: of none.
  void SetManhattanOf(KeyframeId keyframe, ManhattanId manhattan);

  /// Everything that changed since the last call, in parts of a bounded size; each part has its own
  /// version. `answers` and `times` go into the last part. At least one part. In debug builds the
  /// invariants are checked first.
  std::vector<MapDelta> TakeDeltas(KeyframeId answers, const MappingTimes& times);

  /// Forgets what became of landmarks that were fused before version `before`, here and in the
  /// replicas. Who still refers to one of them by then finds it gone.
  void Compact(int64_t before);

 private:
  /// When a landmark was fused into another.
  template <class Id>
  struct Fusion {
    int64_t version = 0;
    Id id;
  };

  template <class Id>
  void ObserveAny(KeyframeId keyframe, int32_t feature, Id id);
  template <class Id>
  void UnobserveAny(KeyframeId keyframe, Id id);
  template <class Id>
  void EraseAny(Id id, Id replacement);
  template <class Id>
  void FuseAny(Id from, Id to);
  void NoteErasure(PointId id);
  void NoteErasure(LineId id);
  void NoteFusion(PointId id) { fused_points_.push_back({version_, id}); }
  void NoteFusion(LineId id) { fused_lines_.push_back({version_, id}); }

  int32_t session_;
  int64_t next_point_ = 0, next_line_ = 0, next_manhattan_ = 0;
  std::map<KeyframeId, std::set<KeyframeId>> children_;  ///< in the spanning tree, of the living
  std::deque<Fusion<PointId>> fused_points_;  ///< that are not forgotten yet, oldest first
  std::deque<Fusion<LineId>> fused_lines_;
  MapChanges changes_;
};

}  // namespace vpslam
