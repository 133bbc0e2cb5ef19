// Maps that turn out to show one place: one is brought into the other's coordinates and joins it.
#include <algorithm>

#include "core/map/map.h"

namespace vpslam {
namespace {

SE3 Scaled(SE3 pose, double scale) {
  pose.translation *= scale;
  return pose;
}

}  // namespace

void Map::Transform(MapId map, const Sim3& new_from_old) {
  for (Keyframe& keyframe : keyframes_) {
    if (!keyframe.id.IsValid() || keyframe.map != map) continue;
    keyframe.cam_from_world = TransformWorld(keyframe.cam_from_world, new_from_old);
    keyframe.cam_from_parent = Scaled(keyframe.cam_from_parent, new_from_old.scale);
    keyframe.unit *= new_from_old.scale;
    changes_.keyframes.insert(keyframe.id);
  }
  for (const MapPoint& point : points_) {
    if (!Find(point.id) || point.map != map) continue;
    SetPosition(point.id, new_from_old * point.position);
    SetView(point.id, new_from_old.rotation * point.normal,
            new_from_old.scale * point.max_distance);
  }
  for (const MapLine& line : lines_) {
    if (!Find(line.id) || line.map != map) continue;
    SetEnds(line.id, new_from_old * line.start, new_from_old * line.end);
  }
  if (const auto manhattan = WorldFromManhattan(map)) {
    SetManhattan(map, (new_from_old.rotation * *manhattan).normalized());
  }
}

void Map::Absorb(MapId from, MapId into) {
  if (from == into) return;
  for (Keyframe& keyframe : keyframes_) {
    if (!keyframe.id.IsValid() || keyframe.map != from) continue;
    keyframe.map = into;
    changes_.keyframes.insert(keyframe.id);
  }
  for (MapPoint& point : points_) {
    if (!Find(point.id) || point.map != from) continue;
    point.map = into;
    changes_.appearances.insert(point.id);
  }
  // Axes are named by the map's Manhattan frame. That of `into` stays, if it has one.
  const auto manhattan = WorldFromManhattan(from);
  const bool keeps_names = !WorldFromManhattan(into);
  for (MapLine& line : lines_) {
    if (!Find(line.id) || line.map != from) continue;
    line.map = into;
    if (!keeps_names) line.axis = -1;
    changes_.lines.insert(line.id);
  }
  if (keeps_names && manhattan) SetManhattan(into, manhattan);
  SetManhattan(from, std::nullopt);
  merged_maps_[from] = into;
  changes_.merged_maps.insert(from);
}

MapId Map::Resolve(MapId id) const {
  // Maps that joined each other would be a bug: end it anyway.
  for (size_t i = 0; i < merged_maps_.size(); ++i) {
    const auto at = merged_maps_.find(id);
    if (at == merged_maps_.end()) break;
    id = at->second;
  }
  return id;
}

std::vector<MapId> Map::Maps() const {
  std::set<MapId> maps;
  for (const Keyframe& keyframe : keyframes_) {
    if (Find(keyframe.id)) maps.insert(keyframe.map);
  }
  return {maps.begin(), maps.end()};
}

int32_t Map::map_end() const {
  int32_t end = 0;
  const auto count = [&end](MapId id) { end = std::max(end, id.value + 1); };
  for (const Keyframe& keyframe : keyframes_) count(keyframe.map);
  for (const MapId id : erased_maps_) count(id);
  for (const auto& [from, into] : merged_maps_) count(from);
  return end;
}

bool Map::Place(KeyframeId reference, const SE3& cam_from_reference, SE3* cam_from_world) const {
  SE3 reference_from_world;
  if (!CamFromWorld(reference, &reference_from_world)) return false;
  *cam_from_world =
      Scaled(cam_from_reference, FindEvenCulled(reference)->unit) * reference_from_world;
  return true;
}

bool Map::Hang(KeyframeId reference, const SE3& cam_from_world, SE3* cam_from_reference) const {
  SE3 reference_from_world;
  if (!CamFromWorld(reference, &reference_from_world)) return false;
  *cam_from_reference =
      Scaled(cam_from_world * reference_from_world.Inverse(), 1 / FindEvenCulled(reference)->unit);
  return true;
}

}  // namespace vpslam
