// The map: keyframes, points, lines, Manhattan frames, and who observes whom. This class is its
// reading side. The backend owns one and changes it (core/map/owned_map.h); frontend, recorder and
// others hold replicas that follow by deltas (core/map/map_replica.h).
//
// Invariants, see core/map/invariants.h: observations are kept on both sides and agree; counts of
// covisibility are those of the observations; what is observed and who observes it belong to one
// map; lists are ordered by id, so that no result depends on the order of a hash table; what was
// fused forwards to what replaced it, for a while.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/base/ids.h"
#include "core/geometry/se3.h"
#include "core/map/id_table.h"
#include "core/map/keyframe.h"
#include "core/map/landmarks.h"
#include "core/map/map_changes.h"
#include "core/messages/map_delta.h"

namespace vpslam {

/// An id that the map does not have: an error of the program, or a delta of another map.
class UnknownIdError : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

/// Three orthogonal directions of the world that vanishing points show.
struct ManhattanAxes {
  ManhattanId id;
  MapId map;
  Eigen::Quaterniond world_from_manhattan = Eigen::Quaterniond::Identity();
};

class Map {
 public:
  /// nullptr if it never existed, or is erased or culled.
  const MapPoint* Find(PointId id) const { return points_.Find(id); }
  const MapLine* Find(LineId id) const { return lines_.Find(id); }
  const Keyframe* Find(KeyframeId id) const { return keyframes_.Find(id); }
  /// Also of culled keyframes; nullptr if it never existed or is erased.
  const KeyframeNode* FindEvenCulled(KeyframeId id) const;
  /// The living point or line that `id` has become; invalid if there is none.
  PointId Resolve(PointId id) const;
  LineId Resolve(LineId id) const;
  /// The map that `id` has become part of; itself if it has not.
  MapId Resolve(MapId id) const;

  /// All that live, by ascending id.
  const IdTable<KeyframeId, Keyframe>& keyframes() const { return keyframes_; }
  const IdTable<PointId, MapPoint>& points() const { return points_; }
  const IdTable<LineId, MapLine>& lines() const { return lines_; }
  const IdTable<KeyframeId, KeyframeNode>& culled_keyframes() const { return culled_; }

  /// Also of culled keyframes, through their parents; false if unknown.
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

  /// Maps that have keyframes, ascending.
  std::vector<MapId> Maps() const;
  int NumKeyframes(MapId map) const { return Count(map).keyframes; }
  int NumPoints(MapId map) const { return Count(map).points; }
  int NumLines(MapId map) const { return Count(map).lines; }
  /// How many maps have become part of others.
  int num_merged() const { return static_cast<int>(merged_maps_.size()); }
  /// The greatest id of a keyframe that was ever in the map; invalid for none.
  KeyframeId latest_keyframe() const { return latest_keyframe_; }
  /// Of what was given by writers of keyframes and maps, the latest session; -1 for nothing. Who
  /// begins to write takes the next one, so that no id is ever given twice.
  int32_t latest_session() const { return latest_session_; }

  /// nullptr if it does not exist (any more).
  const ManhattanAxes* Find(ManhattanId id) const;
  /// Manhattan frames of the map, ascending.
  std::vector<ManhattanAxes> ManhattanFrames(MapId map) const;

  int64_t version() const { return version_; }
  /// The whole map at the present version, in parts; the first clears a replica.
  std::vector<MapDelta> Snapshot() const;

 protected:
  struct Counts {
    int keyframes = 0, points = 0, lines = 0;
  };

  /// The things named, as they are now, in parts of a bounded size.
  std::vector<MapDelta> Parts(const MapChanges& changes) const;

  // Each throws UnknownIdError.
  Keyframe& Get(KeyframeId id) { return GetFrom(keyframes_, id, "keyframe"); }
  MapPoint& Get(PointId id) { return GetFrom(points_, id, "point"); }
  MapLine& Get(LineId id) { return GetFrom(lines_, id, "line"); }

  // What an owner and a replica do alike.
  void AddKeyframe(const Keyframe& keyframe);
  MapPoint& AddPoint(PointId id, MapId map);
  MapLine& AddLine(LineId id, MapId map);
  void AddCulled(const KeyframeNode& node);
  /// The first observation of a landmark in a keyframe stays, and the first landmark of a feature:
  /// false if there is one.
  template <class Id>
  bool AddObservation(KeyframeId keyframe, int32_t feature, Id id);
  /// False if there is none.
  template <class Id>
  bool DropObservation(KeyframeId keyframe, Id id);
  /// With all observations of it. `replacement`: invalid for none.
  template <class Id>
  void DropLandmark(Id id, Id replacement);
  void DropObservationsOf(KeyframeId id);
  /// Its observations must be gone.
  void MakeCulled(KeyframeId id, const SE3& cam_from_parent);
  void DropMap(MapId map);
  void Forget(PointId id) { point_forwards_.erase(id); }
  void Forget(LineId id) { line_forwards_.erase(id); }
  /// From map to map; also a culled keyframe.
  void Move(KeyframeId id, MapId map);
  void Move(PointId id, MapId map) { MoveLandmark(id, map); }
  void Move(LineId id, MapId map) { MoveLandmark(id, map); }
  void NoteMerger(MapId from, MapId into);
  void SetAxes(const ManhattanAxes& axes);
  /// Lines and keyframes that belong to it belong to none afterwards. Returns the lines.
  std::vector<LineId> DropAxes(ManhattanId id);

  IdTable<KeyframeId, Keyframe>& Table(KeyframeId) { return keyframes_; }
  IdTable<PointId, MapPoint>& Table(PointId) { return points_; }
  IdTable<LineId, MapLine>& Table(LineId) { return lines_; }
  std::map<PointId, PointId>& ForwardsOf(PointId) { return point_forwards_; }
  std::map<LineId, LineId>& ForwardsOf(LineId) { return line_forwards_; }
  static std::vector<PointId>& Slots(Keyframe& keyframe, PointId) { return keyframe.points; }
  static std::vector<LineId>& Slots(Keyframe& keyframe, LineId) { return keyframe.lines; }

  IdTable<KeyframeId, Keyframe> keyframes_;
  IdTable<KeyframeId, KeyframeNode> culled_;
  IdTable<PointId, MapPoint> points_;
  IdTable<LineId, MapLine> lines_;
  std::map<PointId, PointId> point_forwards_;  ///< of what was fused: into which
  std::map<LineId, LineId> line_forwards_;
  std::map<ManhattanId, ManhattanAxes> manhattan_frames_;
  std::set<MapId> erased_maps_;
  std::map<MapId, MapId> merged_maps_;  ///< into which
  int64_t version_ = 0;

 private:
  template <class Id, class T>
  static T& GetFrom(IdTable<Id, T>& table, Id id, const char* what) {
    if (T* found = table.Find(id)) return *found;
    throw UnknownIdError(std::string(what) + " " + std::to_string(id.value) + " is not in the map");
  }
  Counts Count(MapId map) const;
  int& CountOf(const MapPoint& point) { return counts_[point.map].points; }
  int& CountOf(const MapLine& line) { return counts_[line.map].lines; }
  void NoteSession(KeyframeId keyframe, MapId map);
  template <class Id>
  void MoveLandmark(Id id, MapId map);
  template <class Landmark>
  void CountShared(const Landmark& landmark, KeyframeId keyframe, int change);
  void ChangeShared(Keyframe* keyframe, KeyframeId other, int change);

  std::map<MapId, Counts> counts_;
  KeyframeId latest_keyframe_;
  int32_t latest_session_ = -1;
};

}  // namespace vpslam
