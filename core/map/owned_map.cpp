#include "core/map/owned_map.h"

#include <algorithm>
#include <stdexcept>

#include "core/map/invariants.h"

namespace vpslam {

OwnedMap::OwnedMap(const Map& map, int32_t session) : Map(map), session_(session) {
  for (const Keyframe& keyframe : keyframes_) {
    if (keyframe.parent.IsValid()) children_[keyframe.parent].insert(keyframe.id);
  }
}

void OwnedMap::Insert(const Keyframe& keyframe) {
  AddKeyframe(keyframe);
  if (keyframe.parent.IsValid()) children_[keyframe.parent].insert(keyframe.id);
  changes_.keyframes.insert(keyframe.id);
  const auto observe = [&](const auto& landmarks) {
    for (size_t i = 0; i < landmarks.size(); ++i) {
      if (Find(landmarks[i])) Observe(keyframe.id, static_cast<int32_t>(i), landmarks[i]);
    }
  };
  observe(keyframe.points);
  observe(keyframe.lines);
}

PointId OwnedMap::CreatePoint(MapId map, KeyframeId reference, const Eigen::Vector3d& position) {
  MapPoint& point = AddPoint(PointId(session_, next_point_++), map);
  point.reference = reference;
  point.position = position;
  changes_.appearances.insert(point.id);
  changes_.geometries.insert(point.id);
  return point.id;
}

LineId OwnedMap::CreateLine(MapId map, KeyframeId reference, const Eigen::Vector3d& start,
                            const Eigen::Vector3d& end) {
  MapLine& line = AddLine(LineId(session_, next_line_++), map);
  line.reference = reference;
  line.start = start;
  line.end = end;
  changes_.lines.insert(line.id);
  return line.id;
}

template <class Id>
void OwnedMap::ObserveAny(KeyframeId keyframe, int32_t feature, Id id) {
  if (AddObservation(keyframe, feature, id)) changes_.keyframes.insert(keyframe);
}

template <class Id>
void OwnedMap::UnobserveAny(KeyframeId keyframe, Id id) {
  if (DropObservation(keyframe, id)) changes_.keyframes.insert(keyframe);
  if (Get(id).observations.size() < 2) EraseAny(id, {});
}

void OwnedMap::NoteErasure(PointId id) {
  changes_.tombstones.insert(id);
  changes_.appearances.erase(id);
  changes_.geometries.erase(id);
}

void OwnedMap::NoteErasure(LineId id) {
  changes_.line_tombstones.insert(id);
  changes_.lines.erase(id);
}

template <class Id>
void OwnedMap::EraseAny(Id id, Id replacement) {
  for (const Observation& o : Get(id).observations) changes_.keyframes.insert(o.keyframe);
  DropLandmark(id, replacement);
  NoteErasure(id);
}

template <class Id>
void OwnedMap::FuseAny(Id from, Id to) {
  if (from == to) return;
  Get(to);
  const std::vector<Observation> moved = Get(from).observations;
  for (const Observation& o : moved) {
    DropObservation(o.keyframe, from);
    changes_.keyframes.insert(o.keyframe);
    ObserveAny(o.keyframe, o.feature, to);
  }
  EraseAny(from, to);
  NoteFusion(from);
}

void OwnedMap::Observe(KeyframeId k, int32_t feature, PointId id) { ObserveAny(k, feature, id); }
void OwnedMap::Observe(KeyframeId k, int32_t segment, LineId id) { ObserveAny(k, segment, id); }
void OwnedMap::Unobserve(KeyframeId keyframe, PointId id) { UnobserveAny(keyframe, id); }
void OwnedMap::Unobserve(KeyframeId keyframe, LineId id) { UnobserveAny(keyframe, id); }
template void OwnedMap::EraseAny(PointId, PointId);
template void OwnedMap::EraseAny(LineId, LineId);
template void OwnedMap::FuseAny(PointId, PointId);
template void OwnedMap::FuseAny(LineId, LineId);

void OwnedMap::Cull(KeyframeId id) {
  const Keyframe& keyframe = Get(id);
  if (!keyframe.parent.IsValid()) return;
  for (const PointId point : std::vector(keyframe.points)) {
    if (point.IsValid()) Unobserve(id, point);
  }
  for (const LineId line : std::vector(keyframe.lines)) {
    if (line.IsValid()) Unobserve(id, line);
  }
  const KeyframeId parent = keyframe.parent;
  SE3 parent_from_world;
  CamFromWorld(parent, &parent_from_world);
  MakeCulled(id, keyframe.cam_from_world * parent_from_world.Inverse());
  changes_.keyframes.insert(id);
  children_[parent].erase(id);
  const auto orphans = children_.extract(id);
  if (orphans.empty()) return;
  for (const KeyframeId child : orphans.mapped()) SetParent(child, parent);
}

void OwnedMap::SetParent(KeyframeId id, KeyframeId parent) {
  Keyframe& keyframe = Get(id);
  Get(parent);
  if (const auto at = children_.find(keyframe.parent); at != children_.end()) at->second.erase(id);
  children_[parent].insert(id);
  keyframe.parent = parent;
  changes_.keyframes.insert(id);
}

void OwnedMap::EraseMap(MapId map) {
  const auto leave = [map](const auto& table, auto* changes) {
    std::erase_if(*changes, [&](auto id) {
      const auto* found = table.Find(id);
      return !found || found->map == map;
    });
  };
  // Tombstones of landmarks of this map do no harm.
  leave(points_, &changes_.appearances);
  leave(points_, &changes_.geometries);
  leave(lines_, &changes_.lines);
  std::erase_if(changes_.keyframes, [&](KeyframeId id) {
    const KeyframeNode* node = FindEvenCulled(id);
    return !node || node->map == map;
  });
  for (const Keyframe& keyframe : keyframes_) {
    if (keyframe.map == map) children_.erase(keyframe.id);
  }
  for (const ManhattanAxes& axes : ManhattanFrames(map)) changes_.manhattan_frames.insert(axes.id);
  DropMap(map);
  changes_.erased_maps.insert(map);
}

void OwnedMap::SetPose(KeyframeId keyframe, const SE3& cam_from_world) {
  Get(keyframe).cam_from_world = cam_from_world;
  changes_.keyframes.insert(keyframe);
}

void OwnedMap::SetPosition(PointId point, const Eigen::Vector3d& position) {
  Get(point).position = position;
  changes_.geometries.insert(point);
}

void OwnedMap::SetView(PointId id, const Eigen::Vector3d& normal, double max_distance) {
  MapPoint& point = Get(id);
  point.normal = normal;
  point.max_distance = max_distance;
  changes_.geometries.insert(id);
}

void OwnedMap::SetDescriptor(PointId id, const Descriptor& descriptor) {
  MapPoint& point = Get(id);
  if (point.descriptor == descriptor) return;
  point.descriptor = descriptor;
  changes_.appearances.insert(id);
}

void OwnedMap::SetEnds(LineId id, const Eigen::Vector3d& start, const Eigen::Vector3d& end) {
  MapLine& line = Get(id);
  line.start = start;
  line.end = end;
  changes_.lines.insert(id);
}

void OwnedMap::SetDescriptor(LineId id, const Descriptor& descriptor) {
  Get(id).descriptor = descriptor;
  changes_.lines.insert(id);
}

ManhattanId OwnedMap::CreateManhattan(MapId map, const Eigen::Quaterniond& world_from_manhattan) {
  const ManhattanId id(session_, next_manhattan_++);
  SetAxes({id, map, world_from_manhattan});
  changes_.manhattan_frames.insert(id);
  return id;
}

void OwnedMap::SetManhattan(ManhattanId id, const Eigen::Quaterniond& world_from_manhattan) {
  const ManhattanAxes* axes = Find(id);
  if (!axes) {
    throw UnknownIdError("Manhattan frame " + std::to_string(id.value) + " is not in the map");
  }
  SetAxes({id, axes->map, world_from_manhattan});
  changes_.manhattan_frames.insert(id);
}

void OwnedMap::EraseManhattan(ManhattanId id) {
  for (const Keyframe& keyframe : keyframes_) {
    if (keyframe.manhattan == id) changes_.keyframes.insert(keyframe.id);
  }
  for (const LineId line : DropAxes(id)) changes_.lines.insert(line);
  changes_.manhattan_frames.insert(id);
}

void OwnedMap::SetAxis(LineId id, ManhattanId manhattan, int32_t axis) {
  MapLine& line = Get(id);
  if (!manhattan.IsValid()) axis = -1;
  if (line.manhattan == manhattan && line.axis == axis) return;
  line.manhattan = manhattan;
  line.axis = axis;
  changes_.lines.insert(id);
}

void OwnedMap::SetManhattanOf(KeyframeId id, ManhattanId manhattan) {
  Keyframe& keyframe = Get(id);
  if (keyframe.manhattan == manhattan) return;
  keyframe.manhattan = manhattan;
  changes_.keyframes.insert(id);
}

std::vector<MapDelta> OwnedMap::TakeDeltas(KeyframeId answers, const MappingTimes& times) {
#ifndef NDEBUG
  if (const auto broken = CheckInvariants(*this)) throw std::logic_error(*broken);
#endif
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

void OwnedMap::Compact(int64_t before) {
  const auto forget = [&](auto* fusions, auto* forgotten) {
    for (; !fusions->empty() && fusions->front().version < before; fusions->pop_front()) {
      Forget(fusions->front().id);
      forgotten->push_back(fusions->front().id);
    }
  };
  forget(&fused_points_, &changes_.forgotten_points);
  forget(&fused_lines_, &changes_.forgotten_lines);
}

}  // namespace vpslam
