// Map's deltas: how changes are cut into parts, and how a replica takes them up.
#include <algorithm>

#include "core/map/map.h"

namespace vpslam {
namespace {

// A part stays below one UDP datagram (65 kB), so that no message is ever fragmented: losing a
// fragment loses the message, and the kernel may cap the buffer at 212 kB.
constexpr size_t kMaxPartBytes = 48'000;
constexpr size_t kKeyframeBytes = 160;
constexpr size_t kFeaturePointBytes = 8;
constexpr size_t kAppearanceBytes = 48;
constexpr size_t kGeometryBytes = 32;
constexpr size_t kTombstoneBytes = 8;

/// Fills parts one after the other, opening a new one when the present is full.
class PartWriter {
 public:
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
  for (size_t i = 0; i < keyframe.points.size(); ++i) {
    if (keyframe.points[i].IsValid()) {
      state.observations.push_back({static_cast<int32_t>(i), keyframe.points[i]});
    }
  }
  return state;
}

std::vector<MapDelta> Map::Parts(const MapChanges& changes) const {
  PartWriter writer;
  // Points before the keyframes that observe them, so that no part refers to what is still to come.
  for (const MapId map : changes.erased_maps) writer.Room(4).erased_maps.push_back(map);
  for (const PointId id : changes.appearances) {
    const MapPoint& p = points_[id.value];
    writer.Room(kAppearanceBytes).appearances.push_back({p.id, p.map, p.reference, p.descriptor});
  }
  for (const PointId id : changes.geometries) {
    const MapPoint& p = points_[id.value];
    writer.Room(kGeometryBytes)
        .geometries.push_back({p.id, p.position.cast<float>(), p.normal.cast<float>(),
                               static_cast<float>(p.max_distance)});
  }
  for (const KeyframeId id : changes.keyframes) {
    KeyframeState state = State(keyframes_[id.value]);
    const size_t bytes = kKeyframeBytes + kFeaturePointBytes * state.observations.size();
    writer.Room(bytes).keyframes.push_back(std::move(state));
  }
  for (const PointId id : changes.tombstones) {
    writer.Room(kTombstoneBytes).tombstones.push_back({id, points_[id.value].replacement});
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

void Map::ApplyObservations(Keyframe& keyframe, const std::vector<FeaturePoint>& observations) {
  const std::vector<PointId> before = keyframe.points;
  for (const PointId id : before) {
    if (id.IsValid() && id.value < point_end()) RemoveObservation(points_[id.value], keyframe.id);
  }
  keyframe.points.clear();
  for (const FeaturePoint& o : observations) {
    if (o.feature < 0 || !Find(o.point)) continue;
    Observe(keyframe.id, o.feature, o.point);
  }
}

bool Map::Apply(const MapDelta& delta) {
  if (!delta.snapshot && delta.base_version != version_) return false;
  if (delta.snapshot) *this = Map();
  for (const MapId map : delta.erased_maps) EraseMap(map);
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
  // Lists of observations are absolute per keyframe: take all old ones away before the new are
  // made, or a feature that changed hands between two keyframes would be refused.
  for (const KeyframeState& s : delta.keyframes) {
    Keyframe& k = Mutable(s.id);
    const std::vector<PointId> points = std::move(k.points);
    k = {s.id,        s.map,
         s.frame_seq, s.stamp_us,
         s.culled,    s.cam_from_world,
         s.parent,    s.cam_from_parent,
         points};
    ApplyObservations(k, s.observations);
  }
  for (const PointTombstone& t : delta.tombstones) {
    MapPoint& p = Mutable(t.id);
    p.id = t.id;
    while (!p.observations.empty()) RemoveObservation(p, p.observations.back().keyframe);
    p.erased = true;
    p.replacement = t.replacement;
  }
  version_ = delta.version;
  changes_ = MapChanges();
  return true;
}

}  // namespace vpslam
