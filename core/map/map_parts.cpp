// A map, or what changed of it, as deltas: how they are cut into parts.
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
  template <class T>
  void Add(T element, std::vector<T> MapDelta::*list, size_t more_bytes = 0) {
    const size_t bytes = WireBytes<T>() + more_bytes;
    if (parts_.empty() || (used_ > 0 && used_ + bytes > kMaxPartBytes)) {
      parts_.emplace_back();
      used_ = 0;
    }
    used_ += bytes;
    (parts_.back().*list).push_back(std::move(element));
  }
  std::vector<MapDelta> Finish() {
    if (parts_.empty()) parts_.emplace_back();
    return std::move(parts_);
  }

 private:
  std::vector<MapDelta> parts_;
  size_t used_ = 0;
};

KeyframeState StateOf(const KeyframeNode& node) {
  KeyframeState state;
  state.id = node.id;
  state.map = node.map;
  state.frame_seq = node.frame_seq;
  state.stamp_us = node.stamp_us;
  state.culled = node.culled;
  state.parent = node.parent;
  state.cam_from_parent = node.cam_from_parent;
  state.unit = node.unit;
  return state;
}

template <class Id>
void List(const std::vector<Id>& slots, std::vector<FeatureObservation<Id>>* observations) {
  for (size_t i = 0; i < slots.size(); ++i) {
    if (slots[i].IsValid()) observations->push_back({static_cast<int32_t>(i), slots[i]});
  }
}

KeyframeState StateOf(const Keyframe& keyframe) {
  KeyframeState state = StateOf(static_cast<const KeyframeNode&>(keyframe));
  state.cam_from_world = keyframe.cam_from_world;
  state.manhattan = keyframe.manhattan;
  List(keyframe.points, &state.points);
  List(keyframe.lines, &state.lines);
  return state;
}

template <class Id>
Id ForwardOf(Id id, const std::map<Id, Id>& forwards) {
  const auto at = forwards.find(id);
  return at == forwards.end() ? Id() : at->second;
}

}  // namespace

std::vector<MapDelta> Map::Parts(const MapChanges& changes) const {
  PartWriter writer;
  for (const MapId map : changes.erased_maps) writer.Add(map, &MapDelta::erased_maps);
  for (const MapId map : changes.merged_maps) {
    writer.Add(MapMerger{map, merged_maps_.at(map)}, &MapDelta::merged_maps);
  }
  // Points and lines before the keyframes that observe them, so that no part refers to what is
  // still to come.
  for (const PointId id : changes.appearances) {
    const MapPoint& p = *Find(id);
    writer.Add(PointAppearance{p.id, p.map, p.reference, p.descriptor}, &MapDelta::appearances);
  }
  for (const PointId id : changes.geometries) {
    const MapPoint& p = *Find(id);
    writer.Add(PointGeometry{p.id, p.position, p.normal, p.max_distance}, &MapDelta::geometries);
  }
  for (const LineId id : changes.lines) {
    const MapLine& l = *Find(id);
    writer.Add(
        LineState{l.id, l.map, l.reference, l.start, l.end, l.descriptor, l.manhattan, l.axis},
        &MapDelta::lines);
  }
  for (const KeyframeId id : changes.keyframes) {
    const Keyframe* keyframe = Find(id);
    KeyframeState state = keyframe ? StateOf(*keyframe) : StateOf(*culled_.Find(id));
    const size_t more_bytes = WireBytes<FeatureObservation<PointId>>() * state.points.size() +
                              WireBytes<FeatureObservation<LineId>>() * state.lines.size();
    writer.Add(std::move(state), &MapDelta::keyframes, more_bytes);
  }
  for (const PointId id : changes.tombstones) {
    writer.Add(Tombstone<PointId>{id, ForwardOf(id, point_forwards_)}, &MapDelta::tombstones);
  }
  for (const LineId id : changes.line_tombstones) {
    writer.Add(Tombstone<LineId>{id, ForwardOf(id, line_forwards_)}, &MapDelta::line_tombstones);
  }
  for (const ManhattanId id : changes.manhattan_frames) {
    const ManhattanAxes* axes = Find(id);
    MapManhattan state{id, axes ? axes->map : MapId(0), std::nullopt};
    if (axes) state.world_from_manhattan = axes->world_from_manhattan;
    writer.Add(state, &MapDelta::manhattan_frames);
  }
  for (const PointId id : changes.forgotten_points) writer.Add(id, &MapDelta::forgotten_points);
  for (const LineId id : changes.forgotten_lines) writer.Add(id, &MapDelta::forgotten_lines);
  return writer.Finish();
}

std::vector<MapDelta> Map::Snapshot() const {
  MapChanges everything;
  everything.erased_maps = erased_maps_;
  for (const auto& [from, into] : merged_maps_) everything.merged_maps.insert(from);
  for (const KeyframeNode& node : culled_) everything.keyframes.insert(node.id);
  for (const Keyframe& keyframe : keyframes_) everything.keyframes.insert(keyframe.id);
  for (const MapPoint& point : points_) {
    everything.appearances.insert(point.id);
    everything.geometries.insert(point.id);
  }
  for (const MapLine& line : lines_) everything.lines.insert(line.id);
  for (const auto& [id, into] : point_forwards_) everything.tombstones.insert(id);
  for (const auto& [id, into] : line_forwards_) everything.line_tombstones.insert(id);
  for (const auto& [id, axes] : manhattan_frames_) everything.manhattan_frames.insert(id);
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

}  // namespace vpslam
