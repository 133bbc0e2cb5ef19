#include "core/map/map.h"

#include <algorithm>
#include <map>
#include <type_traits>

namespace vpslam {
namespace {

constexpr int kMaxTreeDepth = 1'000'000;  // a cycle among parents would be a bug: end it anyway

std::vector<Observation>::iterator LowerBound(std::vector<Observation>& observations,
                                              KeyframeId keyframe) {
  return std::lower_bound(observations.begin(), observations.end(), keyframe,
                          [](const Observation& o, KeyframeId id) { return o.keyframe < id; });
}

template <class Landmarks, class Id>
auto* FindLiving(Landmarks& landmarks, Id id) {
  using Landmark = std::remove_reference_t<decltype(landmarks[0])>;
  if (id.value < 0 || id.value >= static_cast<int32_t>(landmarks.size())) {
    return static_cast<Landmark*>(nullptr);
  }
  Landmark& landmark = landmarks[id.value];
  return landmark.id.IsValid() && !landmark.erased ? &landmark : nullptr;
}

template <class Landmarks, class Id>
Id ResolveAmong(const Landmarks& landmarks, Id id) {
  for (int i = 0; i < kMaxTreeDepth; ++i) {
    if (id.value < 0 || id.value >= static_cast<int32_t>(landmarks.size())) return {};
    if (!landmarks[id.value].id.IsValid()) return {};
    if (!landmarks[id.value].erased) return id;
    id = landmarks[id.value].replacement;
  }
  return {};
}

template <class Landmarks>
int CountIn(const Landmarks& landmarks, MapId map) {
  return static_cast<int>(
      std::count_if(landmarks.begin(), landmarks.end(), [map](const auto& landmark) {
        return landmark.id.IsValid() && !landmark.erased && landmark.map == map;
      }));
}

}  // namespace

// ---- Reading ----

const MapPoint* Map::Find(PointId id) const { return FindLiving(points_, id); }
const MapLine* Map::Find(LineId id) const { return FindLiving(lines_, id); }
PointId Map::Resolve(PointId id) const { return ResolveAmong(points_, id); }
LineId Map::Resolve(LineId id) const { return ResolveAmong(lines_, id); }

const Keyframe* Map::FindEvenCulled(KeyframeId id) const {
  if (id.value < 0 || id.value >= keyframe_end()) return nullptr;
  const Keyframe& keyframe = keyframes_[id.value];
  return keyframe.id.IsValid() ? &keyframe : nullptr;
}

const Keyframe* Map::Find(KeyframeId id) const {
  const Keyframe* keyframe = FindEvenCulled(id);
  return keyframe && !keyframe->culled ? keyframe : nullptr;
}

bool Map::CamFromWorld(KeyframeId id, SE3* cam_from_world) const {
  SE3 cam_from_ancestor;
  for (int i = 0; i < kMaxTreeDepth; ++i) {
    const Keyframe* keyframe = FindEvenCulled(id);
    if (!keyframe) return false;
    if (!keyframe->culled) {
      *cam_from_world = cam_from_ancestor * keyframe->cam_from_world;
      return true;
    }
    cam_from_ancestor = cam_from_ancestor * keyframe->cam_from_parent;
    id = keyframe->parent;
  }
  return false;
}

KeyframeId Map::LivingAncestor(KeyframeId id) const {
  for (int i = 0; i < kMaxTreeDepth; ++i) {
    const Keyframe* keyframe = FindEvenCulled(id);
    if (!keyframe || !keyframe->culled) return keyframe ? id : KeyframeId();
    id = keyframe->parent;
  }
  return {};
}

std::vector<std::pair<KeyframeId, int>> Map::Covisible(KeyframeId id, int min_shared) const {
  const Keyframe* keyframe = Find(id);
  if (!keyframe) return {};
  std::vector<int> shared(keyframes_.size(), 0);
  for (const PointId point_id : keyframe->points) {
    const MapPoint* point = Find(point_id);
    if (!point) continue;
    for (const Observation& o : point->observations) ++shared[o.keyframe.value];
  }
  for (const LineId line_id : keyframe->lines) {
    const MapLine* line = Find(line_id);
    if (!line) continue;
    for (const Observation& o : line->observations) ++shared[o.keyframe.value];
  }
  shared[id.value] = 0;
  std::vector<std::pair<KeyframeId, int>> result;
  for (int32_t i = 0; i < keyframe_end(); ++i) {
    if (shared[i] >= std::max(1, min_shared)) result.emplace_back(KeyframeId(i), shared[i]);
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return result;
}

int Map::NumKeyframes(MapId map) const {
  return static_cast<int>(std::count_if(
      keyframes_.begin(), keyframes_.end(),
      [map](const Keyframe& k) { return k.id.IsValid() && !k.culled && k.map == map; }));
}

int Map::NumPoints(MapId map) const { return CountIn(points_, map); }
int Map::NumLines(MapId map) const { return CountIn(lines_, map); }

std::optional<Eigen::Quaterniond> Map::WorldFromManhattan(MapId map) const {
  const auto at = manhattan_frames_.find(map);
  if (at == manhattan_frames_.end()) return std::nullopt;
  return at->second;
}

// ---- Changing ----

Keyframe& Map::Mutable(KeyframeId id) {
  if (id.value >= keyframe_end()) keyframes_.resize(id.value + 1);
  return keyframes_[id.value];
}

MapPoint& Map::Mutable(PointId id) {
  if (id.value >= point_end()) points_.resize(id.value + 1);
  return points_[id.value];
}

MapLine& Map::Mutable(LineId id) {
  if (id.value >= line_end()) lines_.resize(id.value + 1);
  return lines_[id.value];
}

void Map::Insert(const Keyframe& keyframe) {
  Keyframe& stored = Mutable(keyframe.id);
  stored = keyframe;
  std::fill(stored.points.begin(), stored.points.end(), PointId());
  std::fill(stored.lines.begin(), stored.lines.end(), LineId());
  changes_.keyframes.insert(keyframe.id);
  const auto observe = [&](const auto& landmarks) {
    for (size_t i = 0; i < landmarks.size(); ++i) {
      if (Find(landmarks[i])) Observe(keyframe.id, static_cast<int32_t>(i), landmarks[i]);
    }
  };
  observe(keyframe.points);
  observe(keyframe.lines);
}

PointId Map::CreatePoint(MapId map, KeyframeId reference, const Eigen::Vector3d& position) {
  MapPoint point;
  point.id = PointId(point_end());
  point.map = map;
  point.reference = reference;
  point.position = position;
  points_.push_back(point);
  changes_.appearances.insert(point.id);
  changes_.geometries.insert(point.id);
  return point.id;
}

LineId Map::CreateLine(MapId map, KeyframeId reference, const Eigen::Vector3d& start,
                       const Eigen::Vector3d& end) {
  MapLine line;
  line.id = LineId(line_end());
  line.map = map;
  line.reference = reference;
  line.start = start;
  line.end = end;
  lines_.push_back(line);
  changes_.lines.insert(line.id);
  return line.id;
}

template <class Id>
void Map::ObserveAny(KeyframeId keyframe_id, int32_t feature, Id id) {
  Keyframe& keyframe = Mutable(keyframe_id);
  auto& landmark = Mutable(id);
  std::vector<Id>& slots = Slots(keyframe, id);
  if (feature >= static_cast<int32_t>(slots.size())) slots.resize(feature + 1);
  const auto at = LowerBound(landmark.observations, keyframe_id);
  // One observation of a landmark per keyframe, one landmark per feature: the first stays.
  if (at != landmark.observations.end() && at->keyframe == keyframe_id) return;
  if (slots[feature].IsValid()) return;
  slots[feature] = id;
  landmark.observations.insert(at, {keyframe_id, feature});
  changes_.keyframes.insert(keyframe_id);
}

template <class Landmark>
void Map::RemoveObservation(Landmark& landmark, KeyframeId keyframe_id) {
  const auto at = LowerBound(landmark.observations, keyframe_id);
  if (at == landmark.observations.end() || at->keyframe != keyframe_id) return;
  Slots(Mutable(keyframe_id), landmark.id)[at->feature] = {};
  landmark.observations.erase(at);
  changes_.keyframes.insert(keyframe_id);
}

// For replication.cpp.
template void Map::RemoveObservation(MapPoint&, KeyframeId);
template void Map::RemoveObservation(MapLine&, KeyframeId);

template <class Id>
void Map::UnobserveAny(KeyframeId keyframe_id, Id id) {
  auto& landmark = Mutable(id);
  RemoveObservation(landmark, keyframe_id);
  if (landmark.observations.size() < 2) EraseAny(id);
}

void Map::NoteErasure(PointId id) {
  changes_.tombstones.insert(id);
  changes_.appearances.erase(id);
  changes_.geometries.erase(id);
}

void Map::NoteErasure(LineId id) {
  changes_.line_tombstones.insert(id);
  changes_.lines.erase(id);
}

template <class Id>
void Map::EraseAny(Id id) {
  auto& landmark = Mutable(id);
  if (landmark.erased) return;
  while (!landmark.observations.empty()) {
    RemoveObservation(landmark, landmark.observations.back().keyframe);
  }
  landmark.erased = true;
  NoteErasure(id);
}

template <class Id>
void Map::FuseAny(Id from, Id to) {
  if (from == to) return;
  auto& source = Mutable(from);
  const std::vector<Observation> moved = source.observations;
  for (const Observation& o : moved) {
    RemoveObservation(source, o.keyframe);
    ObserveAny(o.keyframe, o.feature, to);
  }
  source.replacement = to;
  EraseAny(from);
}

void Map::Observe(KeyframeId k, int32_t feature, PointId id) { ObserveAny(k, feature, id); }
void Map::Observe(KeyframeId k, int32_t segment, LineId id) { ObserveAny(k, segment, id); }
void Map::Unobserve(KeyframeId keyframe, PointId id) { UnobserveAny(keyframe, id); }
void Map::Unobserve(KeyframeId keyframe, LineId id) { UnobserveAny(keyframe, id); }
void Map::Erase(PointId id) { EraseAny(id); }
void Map::Erase(LineId id) { EraseAny(id); }
void Map::Fuse(PointId from, PointId to) { FuseAny(from, to); }
void Map::Fuse(LineId from, LineId to) { FuseAny(from, to); }

void Map::Cull(KeyframeId id) {
  Keyframe& keyframe = Mutable(id);
  if (keyframe.culled || !keyframe.parent.IsValid()) return;
  const std::vector<PointId> points = keyframe.points;
  for (const PointId point : points) {
    if (point.IsValid()) Unobserve(id, point);
  }
  const std::vector<LineId> lines = keyframe.lines;
  for (const LineId line : lines) {
    if (line.IsValid()) Unobserve(id, line);
  }
  SE3 parent_from_world;
  CamFromWorld(keyframe.parent, &parent_from_world);
  keyframe.cam_from_parent = keyframe.cam_from_world * parent_from_world.Inverse();
  keyframe.culled = true;
  keyframe.points.clear();
  keyframe.lines.clear();
  changes_.keyframes.insert(id);
  for (Keyframe& child : keyframes_) {
    if (child.id.IsValid() && !child.culled && child.parent == id) {
      child.parent = keyframe.parent;
      changes_.keyframes.insert(child.id);
    }
  }
}

void Map::EraseMap(MapId map) {
  const auto erase = [map](auto& landmark) {
    if (!landmark.id.IsValid() || landmark.map != map) return false;
    landmark.erased = true;
    landmark.observations.clear();
    landmark.replacement = {};
    return true;
  };
  for (MapPoint& point : points_) {
    if (!erase(point)) continue;
    changes_.appearances.erase(point.id);
    changes_.geometries.erase(point.id);
    changes_.tombstones.erase(point.id);
  }
  for (MapLine& line : lines_) {
    if (!erase(line)) continue;
    changes_.lines.erase(line.id);
    changes_.line_tombstones.erase(line.id);
  }
  for (Keyframe& keyframe : keyframes_) {
    if (keyframe.id.IsValid() && keyframe.map == map) {
      changes_.keyframes.erase(keyframe.id);
      keyframe = Keyframe();
    }
  }
  manhattan_frames_.erase(map);
  changes_.manhattan_frames.erase(map);
  erased_maps_.insert(map);
  changes_.erased_maps.insert(map);
}

void Map::SetPose(KeyframeId keyframe, const SE3& cam_from_world) {
  Mutable(keyframe).cam_from_world = cam_from_world;
  changes_.keyframes.insert(keyframe);
}

void Map::SetParent(KeyframeId keyframe, KeyframeId parent) {
  Mutable(keyframe).parent = parent;
  changes_.keyframes.insert(keyframe);
}

void Map::SetPosition(PointId point, const Eigen::Vector3d& position) {
  Mutable(point).position = position;
  changes_.geometries.insert(point);
}

void Map::SetView(PointId point, const Eigen::Vector3d& normal, double max_distance) {
  MapPoint& p = Mutable(point);
  p.normal = normal;
  p.max_distance = max_distance;
  changes_.geometries.insert(point);
}

void Map::SetDescriptor(PointId point, const Descriptor& descriptor) {
  MapPoint& p = Mutable(point);
  if (p.descriptor == descriptor) return;
  p.descriptor = descriptor;
  changes_.appearances.insert(point);
}

void Map::SetEnds(LineId line, const Eigen::Vector3d& start, const Eigen::Vector3d& end) {
  MapLine& l = Mutable(line);
  l.start = start;
  l.end = end;
  changes_.lines.insert(line);
}

void Map::SetDescriptor(LineId line, const Descriptor& descriptor) {
  Mutable(line).descriptor = descriptor;
  changes_.lines.insert(line);
}

void Map::SetAxis(LineId line, int32_t axis) {
  if (Mutable(line).axis == axis) return;
  Mutable(line).axis = axis;
  changes_.lines.insert(line);
}

void Map::SetManhattan(MapId map, const std::optional<Eigen::Quaterniond>& world_from_manhattan) {
  if (world_from_manhattan) {
    manhattan_frames_[map] = *world_from_manhattan;
  } else {
    if (manhattan_frames_.erase(map) == 0) return;
    for (const MapLine& line : lines_) {
      if (line.map == map && Find(line.id)) SetAxis(line.id, -1);
    }
  }
  changes_.manhattan_frames.insert(map);
}

}  // namespace vpslam
