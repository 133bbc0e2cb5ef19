#include "core/map/map_replica.h"

namespace vpslam {
namespace {

/// No delta continues it.
constexpr int64_t kNoVersion = std::numeric_limits<int64_t>::min();

}  // namespace

void MapReplica::Take(const PointAppearance& a) {
  MapPoint* point = points_.Find(a.id);
  if (!point) point = &AddPoint(a.id, a.map);
  if (point->map != a.map) Move(a.id, a.map);
  point->reference = a.reference;
  point->descriptor = a.descriptor;
}

void MapReplica::Take(const PointGeometry& g) {
  MapPoint& point = Get(g.id);
  point.position = g.position;
  point.normal = g.normal;
  point.max_distance = g.max_distance;
}

void MapReplica::Take(const LineState& s) {
  MapLine* line = lines_.Find(s.id);
  if (!line) line = &AddLine(s.id, s.map);
  if (line->map != s.map) Move(s.id, s.map);
  line->reference = s.reference;
  line->start = s.start;
  line->end = s.end;
  line->descriptor = s.descriptor;
  line->manhattan = s.manhattan;
  line->axis = s.axis;
}

void MapReplica::Take(const KeyframeState& s) {
  if (keyframes_.Find(s.id)) {
    if (s.culled) {
      DropObservationsOf(s.id);
      MakeCulled(s.id, s.cam_from_parent);
    }
  } else if (!culled_.Find(s.id)) {
    Keyframe fresh;
    fresh.id = s.id;
    fresh.map = s.map;
    if (s.culled) {
      AddCulled(fresh);
    } else {
      AddKeyframe(fresh);
    }
  }
  if (FindEvenCulled(s.id)->map != s.map) Move(s.id, s.map);
  KeyframeNode& node = s.culled ? *culled_.Find(s.id) : Get(s.id);
  node.frame_seq = s.frame_seq;
  node.stamp_us = s.stamp_us;
  node.parent = s.parent;
  node.cam_from_parent = s.cam_from_parent;
  node.unit = s.unit;
  if (s.culled) return;
  Keyframe& keyframe = Get(s.id);
  keyframe.cam_from_world = s.cam_from_world;
  keyframe.manhattan = s.manhattan;
  TakeObservations(s.id, s.points);
  TakeObservations(s.id, s.lines);
}

/// Lists of observations are absolute: what is not in it any more is taken away before the new ones
/// are made, or a feature that changed hands would be refused.
template <class Id>
void MapReplica::TakeObservations(KeyframeId keyframe,
                                  const std::vector<FeatureObservation<Id>>& now) {
  std::vector<Id>& slots = Slots(Get(keyframe), Id());
  const auto stays = [&slots](const FeatureObservation<Id>& o) {
    return o.feature < std::ssize(slots) && slots[static_cast<size_t>(o.feature)] == o.landmark;
  };
  // Of a keyframe that only moved, all do.
  std::vector<bool> kept(slots.size(), false);
  for (const FeatureObservation<Id>& o : now) {
    if (stays(o)) kept[static_cast<size_t>(o.feature)] = true;
  }
  for (size_t i = 0; i < kept.size(); ++i) {
    if (!kept[i] && slots[i].IsValid()) DropObservation(keyframe, slots[i]);
  }
  for (const FeatureObservation<Id>& o : now) {
    if (!stays(o)) AddObservation(keyframe, o.feature, o.landmark);
  }
  while (!slots.empty() && !slots.back().IsValid()) slots.pop_back();
}

template <class Id>
void MapReplica::Take(const Tombstone<Id>& tombstone) {
  if (Find(tombstone.id)) {
    DropLandmark(tombstone.id, tombstone.replacement);
  } else if (tombstone.replacement.IsValid()) {
    ForwardsOf(tombstone.id)[tombstone.id] = tombstone.replacement;
  }
}

void MapReplica::Take(const MapManhattan& m) {
  if (m.world_from_manhattan) {
    SetAxes({m.id, m.map, *m.world_from_manhattan});
  } else {
    DropAxes(m.id);
  }
}

bool MapReplica::Apply(const MapDelta& delta) {
  if (!delta.snapshot && delta.base_version != version_) return false;
  if (delta.snapshot) *this = MapReplica();
  try {
    for (const MapId map : delta.erased_maps) DropMap(map);
    for (const MapMerger& merger : delta.merged_maps) NoteMerger(merger.merged, merger.into);
    // Landmarks before the keyframes that observe them.
    for (const PointAppearance& appearance : delta.appearances) Take(appearance);
    for (const PointGeometry& geometry : delta.geometries) Take(geometry);
    for (const LineState& line : delta.lines) Take(line);
    for (const KeyframeState& keyframe : delta.keyframes) Take(keyframe);
    for (const Tombstone<PointId>& tombstone : delta.tombstones) Take(tombstone);
    for (const Tombstone<LineId>& tombstone : delta.line_tombstones) Take(tombstone);
    for (const MapManhattan& manhattan : delta.manhattan_frames) Take(manhattan);
    for (const PointId id : delta.forgotten_points) Forget(id);
    for (const LineId id : delta.forgotten_lines) Forget(id);
  } catch (const UnknownIdError&) {
    version_ = kNoVersion;
    return false;
  }
  version_ = delta.version;
  return true;
}

}  // namespace vpslam
