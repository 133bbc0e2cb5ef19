// Maps that turn out to show one place: one is brought into the other's coordinates and joins it.
#include "core/map/owned_map.h"

namespace vpslam {

void OwnedMap::Transform(MapId map, const Sim3& new_from_old) {
  const auto scale_tree = [&](KeyframeNode* node) {
    node->cam_from_parent.translation *= new_from_old.scale;
    node->unit *= new_from_old.scale;
    changes_.keyframes.insert(node->id);
  };
  for (const KeyframeNode& node : culled_) {
    if (node.map == map) scale_tree(culled_.Find(node.id));
  }
  for (const Keyframe& keyframe : keyframes_) {
    if (keyframe.map != map) continue;
    Keyframe& mine = Get(keyframe.id);
    scale_tree(&mine);
    mine.cam_from_world = TransformWorld(mine.cam_from_world, new_from_old);
  }
  for (const MapPoint& point : points_) {
    if (point.map != map) continue;
    SetPosition(point.id, new_from_old * point.position);
    SetView(point.id, new_from_old.rotation * point.normal,
            new_from_old.scale * point.max_distance);
  }
  for (const MapLine& line : lines_) {
    if (line.map != map) continue;
    SetEnds(line.id, new_from_old * line.start, new_from_old * line.end);
  }
  for (const ManhattanAxes& axes : ManhattanFrames(map)) {
    SetManhattan(axes.id, (new_from_old.rotation * axes.world_from_manhattan).normalized());
  }
}

void OwnedMap::Absorb(MapId from, MapId into) {
  if (from == into) return;
  const auto take_all = [&](const auto& table, const auto& note) {
    for (const auto& each : table) {
      if (each.map != from) continue;
      Move(each.id, into);
      note(each.id);
    }
  };
  take_all(culled_, [&](KeyframeId id) { changes_.keyframes.insert(id); });
  take_all(keyframes_, [&](KeyframeId id) { changes_.keyframes.insert(id); });
  take_all(points_, [&](PointId id) { changes_.appearances.insert(id); });
  take_all(lines_, [&](LineId id) { changes_.lines.insert(id); });
  for (ManhattanAxes axes : ManhattanFrames(from)) {
    axes.map = into;
    SetAxes(axes);
    changes_.manhattan_frames.insert(axes.id);
  }
  NoteMerger(from, into);
  changes_.merged_maps.insert(from);
}

}  // namespace vpslam
