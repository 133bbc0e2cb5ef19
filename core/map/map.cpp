#include "core/map/map.h"

#include <algorithm>
#include <map>

namespace vpslam {
namespace {

constexpr int kMaxTreeDepth = 1'000'000;  // a cycle among parents would be a bug: end it anyway

std::vector<Observation>::iterator LowerBound(std::vector<Observation>& observations,
                                              KeyframeId keyframe) {
  return std::lower_bound(observations.begin(), observations.end(), keyframe,
                          [](const Observation& o, KeyframeId id) { return o.keyframe < id; });
}

}  // namespace

// ---- Reading ----

const MapPoint* Map::Find(PointId id) const {
  if (id.value < 0 || id.value >= point_end()) return nullptr;
  const MapPoint& point = points_[id.value];
  return point.id.IsValid() && !point.erased ? &point : nullptr;
}

const Keyframe* Map::FindEvenCulled(KeyframeId id) const {
  if (id.value < 0 || id.value >= keyframe_end()) return nullptr;
  const Keyframe& keyframe = keyframes_[id.value];
  return keyframe.id.IsValid() ? &keyframe : nullptr;
}

const Keyframe* Map::Find(KeyframeId id) const {
  const Keyframe* keyframe = FindEvenCulled(id);
  return keyframe && !keyframe->culled ? keyframe : nullptr;
}

PointId Map::Resolve(PointId id) const {
  for (int i = 0; i < kMaxTreeDepth; ++i) {
    if (id.value < 0 || id.value >= point_end() || !points_[id.value].id.IsValid()) return {};
    if (!points_[id.value].erased) return id;
    id = points_[id.value].replacement;
  }
  return {};
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

int Map::NumPoints(MapId map) const {
  return static_cast<int>(std::count_if(points_.begin(), points_.end(), [map](const MapPoint& p) {
    return p.id.IsValid() && !p.erased && p.map == map;
  }));
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

void Map::Insert(const Keyframe& keyframe) {
  Mutable(keyframe.id) = keyframe;
  std::fill(keyframes_[keyframe.id.value].points.begin(),
            keyframes_[keyframe.id.value].points.end(), PointId());
  changes_.keyframes.insert(keyframe.id);
  for (size_t i = 0; i < keyframe.points.size(); ++i) {
    if (Find(keyframe.points[i])) {
      Observe(keyframe.id, static_cast<int32_t>(i), keyframe.points[i]);
    }
  }
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

void Map::Observe(KeyframeId keyframe_id, int32_t feature, PointId point_id) {
  Keyframe& keyframe = Mutable(keyframe_id);
  MapPoint& point = Mutable(point_id);
  if (feature >= static_cast<int32_t>(keyframe.points.size())) keyframe.points.resize(feature + 1);
  const auto at = LowerBound(point.observations, keyframe_id);
  // One observation of a point per keyframe, one point per feature: the first stays.
  if (at != point.observations.end() && at->keyframe == keyframe_id) return;
  if (keyframe.points[feature].IsValid()) return;
  keyframe.points[feature] = point_id;
  point.observations.insert(at, {keyframe_id, feature});
  changes_.keyframes.insert(keyframe_id);
}

void Map::RemoveObservation(MapPoint& point, KeyframeId keyframe_id) {
  const auto at = LowerBound(point.observations, keyframe_id);
  if (at == point.observations.end() || at->keyframe != keyframe_id) return;
  Mutable(keyframe_id).points[at->feature] = PointId();
  point.observations.erase(at);
  changes_.keyframes.insert(keyframe_id);
}

void Map::Unobserve(KeyframeId keyframe_id, PointId point_id) {
  MapPoint& point = Mutable(point_id);
  RemoveObservation(point, keyframe_id);
  if (point.observations.size() < 2) Erase(point_id);
}

void Map::Erase(PointId point_id) {
  MapPoint& point = Mutable(point_id);
  if (point.erased) return;
  while (!point.observations.empty()) {
    RemoveObservation(point, point.observations.back().keyframe);
  }
  point.erased = true;
  changes_.tombstones.insert(point_id);
  changes_.appearances.erase(point_id);
  changes_.geometries.erase(point_id);
}

void Map::Fuse(PointId from, PointId to) {
  if (from == to) return;
  MapPoint& source = Mutable(from);
  const std::vector<Observation> moved = source.observations;
  for (const Observation& o : moved) {
    RemoveObservation(source, o.keyframe);
    Observe(o.keyframe, o.feature, to);
  }
  source.replacement = to;
  Erase(from);
}

void Map::Cull(KeyframeId id) {
  Keyframe& keyframe = Mutable(id);
  if (keyframe.culled || !keyframe.parent.IsValid()) return;
  const std::vector<PointId> observed = keyframe.points;
  for (const PointId point : observed) {
    if (point.IsValid()) Unobserve(id, point);
  }
  SE3 parent_from_world;
  CamFromWorld(keyframe.parent, &parent_from_world);
  keyframe.cam_from_parent = keyframe.cam_from_world * parent_from_world.Inverse();
  keyframe.culled = true;
  keyframe.points.clear();
  changes_.keyframes.insert(id);
  for (Keyframe& child : keyframes_) {
    if (child.id.IsValid() && !child.culled && child.parent == id) {
      child.parent = keyframe.parent;
      changes_.keyframes.insert(child.id);
    }
  }
}

void Map::EraseMap(MapId map) {
  for (MapPoint& point : points_) {
    if (point.id.IsValid() && point.map == map) {
      point.erased = true;
      point.observations.clear();
      point.replacement = PointId();
      changes_.appearances.erase(point.id);
      changes_.geometries.erase(point.id);
      changes_.tombstones.erase(point.id);
    }
  }
  for (Keyframe& keyframe : keyframes_) {
    if (keyframe.id.IsValid() && keyframe.map == map) {
      changes_.keyframes.erase(keyframe.id);
      keyframe = Keyframe();
    }
  }
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

}  // namespace vpslam
