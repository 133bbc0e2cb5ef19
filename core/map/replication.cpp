// Map's deltas: how changes are cut into parts, and how a replica takes them up.
#include <algorithm>

#include "core/map/map.h"
#include "core/messages/array_lengths.h"

namespace vpslam {
namespace {

// A part stays below one UDP datagram (65 kB), so that no message is ever fragmented: losing a
// fragment loses the message, and the kernel may cap the buffer at 213 kB.
constexpr size_t kMaxPartBytes = 48'000;

/// Fills parts one after the other, opening a new one when the present is full.
class PartWriter {
 public:
  /// Adds an element to one of the lists of a part.
  template <class T>
  void Add(std::vector<T> MapDelta::*list, T element) {
    (Room(WireBytes<T>()).*list).push_back(std::move(element));
  }
  MapDelta& Room(size_t bytes) {
    if (parts_.empty() || (used_ > 0 && used_ + bytes > kMaxPartBytes)) {
      parts_.emplace_back();
      used_ = 0;
    }
    used_ += bytes;
    return parts_.back();
  }
  std::vector<MapDelta> Finish() {
    if (parts_.empty()) parts_.emplace_back();
    return std::move(parts_);
  }

 private:
  std::vector<MapDelta> parts_;
  size_t used_ = 0;
};

}  // namespace

KeyframeState Map::State(const Keyframe& keyframe) const {
  KeyframeState state;
  state.id = keyframe.id;
  state.map = keyframe.map;
  state.frame_seq = keyframe.frame_seq;
  state.stamp_us = keyframe.stamp_us;
  state.culled = keyframe.culled;
  state.cam_from_world = keyframe.cam_from_world;
  state.parent = keyframe.parent;
  state.cam_from_parent = keyframe.cam_from_parent;
  state.unit = keyframe.unit;
  const auto list = [](const auto& slots, auto* observations) {
    for (size_t i = 0; i < slots.size(); ++i) {
      if (slots[i].IsValid()) observations->push_back({static_cast<int32_t>(i), slots[i]});
    }
  };
  list(keyframe.points, &state.points);
  list(keyframe.lines, &state.lines);
  return state;
}

std::vector<MapDelta> Map::Parts(const MapChanges& changes) const {
  PartWriter writer;
  // Points and lines before the keyframes that observe them, so that no part refers to what is
  // still to come.
  for (const MapId map : changes.erased_maps) writer.Add(&MapDelta::erased_maps, map);
  for (const MapId map : changes.merged_maps) {
    writer.Add(&MapDelta::merged_maps, {map, merged_maps_.at(map)});
  }
  for (const PointId id : changes.appearances) {
    const MapPoint& p = points_[id.value];
    writer.Add(&MapDelta::appearances, {p.id, p.map, p.reference, p.descriptor});
  }
  for (const PointId id : changes.geometries) {
    const MapPoint& p = points_[id.value];
    writer.Add(&MapDelta::geometries, {p.id, p.position.cast<float>(), p.normal.cast<float>(),
                                       static_cast<float>(p.max_distance)});
  }
  for (const LineId id : changes.lines) {
    const MapLine& l = lines_[id.value];
    writer.Add(&MapDelta::lines, {l.id, l.map, l.reference, l.start.cast<float>(),
                                  l.end.cast<float>(), l.descriptor, l.axis});
  }
  for (const KeyframeId id : changes.keyframes) {
    KeyframeState state = State(keyframes_[id.value]);
    const size_t bytes = WireBytes<KeyframeState>() +
                         WireBytes<FeatureObservation<PointId>>() * state.points.size() +
                         WireBytes<FeatureObservation<LineId>>() * state.lines.size();
    writer.Room(bytes).keyframes.push_back(std::move(state));
  }
  for (const PointId id : changes.tombstones) {
    writer.Add(&MapDelta::tombstones, {id, points_[id.value].replacement});
  }
  for (const LineId id : changes.line_tombstones) {
    writer.Add(&MapDelta::line_tombstones, {id, lines_[id.value].replacement});
  }
  for (const MapId map : changes.manhattan_frames) {
    writer.Add(&MapDelta::manhattan_frames, {map, WorldFromManhattan(map)});
  }
  return writer.Finish();
}

std::vector<MapDelta> Map::TakeDeltas(KeyframeId answers, const MappingTimes& times) {
  std::vector<MapDelta> parts = Parts(changes_);
  changes_ = MapChanges();
  for (MapDelta& part : parts) {
    part.base_version = version_;
    part.version = ++version_;
  }
  parts.back().answers = answers;
  parts.back().times = times;
  return parts;
}

std::vector<MapDelta> Map::Snapshot() const {
  MapChanges everything;
  everything.erased_maps = erased_maps_;
  for (const auto& [from, into] : merged_maps_) everything.merged_maps.insert(from);
  for (const Keyframe& k : keyframes_) {
    if (k.id.IsValid()) everything.keyframes.insert(k.id);
  }
  for (const MapPoint& p : points_) {
    if (!p.id.IsValid()) continue;
    if (p.erased) {
      if (p.replacement.IsValid()) everything.tombstones.insert(p.id);
    } else {
      everything.appearances.insert(p.id);
      everything.geometries.insert(p.id);
    }
  }
  for (const MapLine& l : lines_) {
    if (!l.id.IsValid()) continue;
    if (!l.erased) everything.lines.insert(l.id);
    if (l.erased && l.replacement.IsValid()) everything.line_tombstones.insert(l.id);
  }
  for (const auto& [map, frame] : manhattan_frames_) everything.manhattan_frames.insert(map);
  std::vector<MapDelta> parts = Parts(everything);
  // Intermediate versions are negative: a replica that holds half a snapshot can't be mistaken for
  // one at a real version, and takes up deltas only once the last part has come.
  const auto n = static_cast<int64_t>(parts.size());
  for (int64_t i = 0; i < n; ++i) {
    parts[i].snapshot = i == 0;
    parts[i].base_version = i == 0 ? 0 : -i;
    parts[i].version = i + 1 == n ? version_ : -(i + 1);
  }
  return parts;
}

template <class Id>
void Map::ApplyObservations(KeyframeId keyframe, const std::vector<FeatureObservation<Id>>& now) {
  std::vector<Id>& slots = Slots(Mutable(keyframe), Id());
  const auto stays = [&slots](const FeatureObservation<Id>& o) {
    return o.feature < std::ssize(slots) && slots[o.feature] == o.landmark;
  };
  // Of a keyframe that only moved, all do.
  std::vector<bool> kept(slots.size(), false);
  for (const FeatureObservation<Id>& o : now) {
    if (o.feature >= 0 && stays(o)) kept[o.feature] = true;
  }
  for (size_t i = 0; i < kept.size(); ++i) {
    if (!kept[i] && slots[i].IsValid()) RemoveObservation(Mutable(slots[i]), keyframe);
  }
  for (const FeatureObservation<Id>& o : now) {
    if (o.feature >= 0 && !stays(o) && Find(o.landmark)) Observe(keyframe, o.feature, o.landmark);
  }
  while (!slots.empty() && !slots.back().IsValid()) slots.pop_back();
}

template <class Id>
void Map::ApplyTombstone(const Tombstone<Id>& tombstone) {
  auto& landmark = Mutable(tombstone.id);
  landmark.id = tombstone.id;
  while (!landmark.observations.empty()) {
    RemoveObservation(landmark, landmark.observations.back().keyframe);
  }
  landmark.erased = true;
  landmark.replacement = tombstone.replacement;
}

bool Map::Apply(const MapDelta& delta) {
  if (!delta.snapshot && delta.base_version != version_) return false;
  if (delta.snapshot) *this = Map();
  for (const MapId map : delta.erased_maps) EraseMap(map);
  for (const MapMerger& merger : delta.merged_maps) merged_maps_[merger.from] = merger.into;
  for (const PointAppearance& a : delta.appearances) {
    MapPoint& p = Mutable(a.id);
    p.id = a.id;
    p.map = a.map;
    p.reference = a.reference;
    p.descriptor = a.descriptor;
    p.erased = false;
  }
  for (const PointGeometry& g : delta.geometries) {
    MapPoint& p = Mutable(g.id);
    p.position = g.position.cast<double>();
    p.normal = g.normal.cast<double>();
    p.max_distance = g.max_distance;
  }
  for (const LineState& state : delta.lines) {
    MapLine& l = Mutable(state.id);
    l.id = state.id;
    l.map = state.map;
    l.reference = state.reference;
    l.start = state.start.cast<double>();
    l.end = state.end.cast<double>();
    l.descriptor = state.descriptor;
    l.axis = state.axis;
    l.erased = false;
  }
  // Lists of observations are absolute per keyframe: take all old ones away before the new are
  // made, or a feature that changed hands between two keyframes would be refused.
  for (const KeyframeState& s : delta.keyframes) {
    Keyframe& k = Mutable(s.id);
    k.id = s.id;
    k.map = s.map;
    k.frame_seq = s.frame_seq;
    k.stamp_us = s.stamp_us;
    k.culled = s.culled;
    k.cam_from_world = s.cam_from_world;
    k.parent = s.parent;
    k.cam_from_parent = s.cam_from_parent;
    k.unit = s.unit;
    ApplyObservations(s.id, s.points);
    ApplyObservations(s.id, s.lines);
  }
  for (const auto& tombstone : delta.tombstones) ApplyTombstone(tombstone);
  for (const auto& tombstone : delta.line_tombstones) ApplyTombstone(tombstone);
  for (const MapManhattan& m : delta.manhattan_frames) SetManhattan(m.map, m.world_from_manhattan);
  version_ = delta.version;
  changes_ = MapChanges();
  return true;
}

}  // namespace vpslam
