#include "core/map/invariants.h"

#include <cmath>
#include <map>
#include <utility>

namespace vpslam {
namespace {

using Broken = std::optional<std::string>;

template <class Id>
std::string Name(const char* what, Id id) {
  return std::string(what) + " " + std::to_string(id.value);
}

bool IsSound(const SE3& pose) {
  return pose.translation.allFinite() && std::abs(pose.rotation.norm() - 1) < 1e-6;
}

bool IsSound(const MapPoint& p) {
  return p.position.allFinite() && p.normal.allFinite() && std::isfinite(p.max_distance);
}

bool IsSound(const MapLine& l) { return l.start.allFinite() && l.end.allFinite(); }

const std::vector<PointId>& Slots(const Keyframe& keyframe, PointId) { return keyframe.points; }
const std::vector<LineId>& Slots(const Keyframe& keyframe, LineId) { return keyframe.lines; }

template <class Landmark>
Broken CheckLandmark(const Landmark& landmark, const char* what, const Map& map) {
  const std::string name = Name(what, landmark.id);
  if (!IsSound(landmark)) return name + " has a number that is not finite";
  KeyframeId before;
  for (const Observation& o : landmark.observations) {
    if (o.keyframe <= before) return name + ": observations out of order";
    before = o.keyframe;
    const Keyframe* keyframe = map.Find(o.keyframe);
    if (!keyframe) return name + " is observed by a keyframe that is not there";
    if (keyframe->map != landmark.map) return name + " is observed from another map";
    const auto& slots = Slots(*keyframe, landmark.id);
    if (o.feature < 0 || o.feature >= std::ssize(slots) ||
        slots[static_cast<size_t>(o.feature)] != landmark.id) {
      return name + ": " + Name("keyframe", o.keyframe) + " does not know of its observation";
    }
  }
  return std::nullopt;
}

template <class Id>
Broken CheckSlots(const Keyframe& keyframe, const std::vector<Id>& slots, const char* what,
                  const Map& map) {
  for (size_t i = 0; i < slots.size(); ++i) {
    if (!slots[i].IsValid()) continue;
    const auto* landmark = map.Find(slots[i]);
    if (!landmark) {
      return Name("keyframe", keyframe.id) + " observes " + Name(what, slots[i]) +
             ", which is not there";
    }
    bool known = false;
    for (const Observation& o : landmark->observations) {
      known = known || o == Observation{keyframe.id, static_cast<int32_t>(i)};
    }
    if (!known) {
      return Name(what, slots[i]) + " does not know that " + Name("keyframe", keyframe.id) +
             " observes it";
    }
  }
  return std::nullopt;
}

Broken CheckTree(const KeyframeNode& node, const Map& map) {
  const std::string name = Name("keyframe", node.id);
  if (!(node.unit > 0) || !std::isfinite(node.unit)) return name + " has no unit of length";
  if (!node.parent.IsValid()) {
    return node.culled ? Broken(name + " was culled and has no parent") : std::nullopt;
  }
  const KeyframeNode* parent = map.FindEvenCulled(node.parent);
  if (!parent) return name + " has a parent that is not there";
  if (parent->map != node.map) return name + " has a parent in another map";
  if (node.culled) {
    return IsSound(node.cam_from_parent) ? std::nullopt
                                         : Broken(name + " has no pose in its parent");
  }
  if (parent->culled) return name + " lives and has a parent that was culled";
  return std::nullopt;
}

Broken CheckKeyframe(const Keyframe& keyframe, const Map& map) {
  const std::string name = Name("keyframe", keyframe.id);
  if (!IsSound(keyframe.cam_from_world)) return name + " has a pose that is none";
  if (const Broken why = CheckTree(keyframe, map)) return why;
  if (keyframe.parent.IsValid() && !(keyframe.parent < keyframe.id)) {
    return name + " has a parent that is not older";
  }
  if (keyframe.manhattan.IsValid()) {
    const ManhattanAxes* axes = map.Find(keyframe.manhattan);
    if (!axes || axes->map != keyframe.map) return name + " sees axes that its map does not have";
  }
  if (keyframe.seen) {
    if (std::ssize(keyframe.points) > keyframe.seen->num_features()) {
      return name + " has more points than features";
    }
    if (std::ssize(keyframe.lines) > keyframe.seen->num_segments()) {
      return name + " has more lines than segments";
    }
  }
  if (const Broken why = CheckSlots(keyframe, keyframe.points, "point", map)) return why;
  return CheckSlots(keyframe, keyframe.lines, "line", map);
}

Broken CheckAxis(const MapLine& line, const Map& map) {
  const std::string name = Name("line", line.id);
  if (line.manhattan.IsValid() != (line.axis >= 0) || line.axis > 2) {
    return name + " has half an axis";
  }
  if (line.axis < 0) return std::nullopt;
  const ManhattanAxes* axes = map.Find(line.manhattan);
  if (!axes || axes->map != line.map) return name + " has an axis that its map does not have";
  return std::nullopt;
}

using SharedCounts = std::map<std::pair<KeyframeId, KeyframeId>, int>;

template <class Landmarks>
void CountShared(const Landmarks& landmarks, SharedCounts* shared) {
  for (const auto& landmark : landmarks) {
    for (const Observation& a : landmark.observations) {
      for (const Observation& b : landmark.observations) {
        if (a.keyframe != b.keyframe) ++(*shared)[{a.keyframe, b.keyframe}];
      }
    }
  }
}

Broken CheckCovisibility(const Map& map) {
  SharedCounts shared;
  CountShared(map.points(), &shared);
  CountShared(map.lines(), &shared);
  for (const Keyframe& keyframe : map.keyframes()) {
    std::vector<Covisibility> expected;
    for (auto at = shared.lower_bound({keyframe.id, KeyframeId()});
         at != shared.end() && at->first.first == keyframe.id; ++at) {
      expected.push_back({at->first.second, at->second});
    }
    if (expected != keyframe.covisible) {
      return Name("keyframe", keyframe.id) + " has wrong counts of covisibility";
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<std::string> CheckInvariants(const Map& map) {
  for (const MapPoint& point : map.points()) {
    if (const Broken why = CheckLandmark(point, "point", map)) return why;
  }
  for (const MapLine& line : map.lines()) {
    if (const Broken why = CheckLandmark(line, "line", map)) return why;
    if (const Broken why = CheckAxis(line, map)) return why;
  }
  for (const Keyframe& keyframe : map.keyframes()) {
    if (const Broken why = CheckKeyframe(keyframe, map)) return why;
  }
  for (const KeyframeNode& node : map.culled_keyframes()) {
    if (map.Find(node.id)) return Name("keyframe", node.id) + " lives and was culled";
    if (const Broken why = CheckTree(node, map)) return why;
  }
  return CheckCovisibility(map);
}

}  // namespace vpslam
