#include "core/map/map.h"

#include <algorithm>

namespace vpslam {
namespace {

constexpr int kMaxTreeDepth = 1'000'000;  // a cycle among parents would be a bug: end it anyway

SE3 Scaled(SE3 pose, double scale) {
  pose.translation *= scale;
  return pose;
}

std::vector<Observation>::iterator LowerBound(std::vector<Observation>& observations,
                                              KeyframeId keyframe) {
  return std::lower_bound(observations.begin(), observations.end(), keyframe,
                          [](const Observation& o, KeyframeId id) { return o.keyframe < id; });
}

template <class Table, class Id>
Id ResolveAmong(const Table& living, const std::map<Id, Id>& forwards, Id id) {
  for (size_t i = 0; i <= forwards.size(); ++i) {
    if (living.Find(id)) return id;
    const auto at = forwards.find(id);
    if (at == forwards.end()) return {};
    id = at->second;
  }
  return {};
}

}  // namespace

// ---- Reading ----

PointId Map::Resolve(PointId id) const { return ResolveAmong(points_, point_forwards_, id); }
LineId Map::Resolve(LineId id) const { return ResolveAmong(lines_, line_forwards_, id); }

MapId Map::Resolve(MapId id) const {
  // Maps that joined each other would be a bug: end it anyway.
  for (size_t i = 0; i < merged_maps_.size(); ++i) {
    const auto at = merged_maps_.find(id);
    if (at == merged_maps_.end()) break;
    id = at->second;
  }
  return id;
}

const KeyframeNode* Map::FindEvenCulled(KeyframeId id) const {
  if (const Keyframe* keyframe = keyframes_.Find(id)) return keyframe;
  return culled_.Find(id);
}

bool Map::CamFromWorld(KeyframeId id, SE3* cam_from_world) const {
  SE3 cam_from_ancestor;
  for (int i = 0; i < kMaxTreeDepth; ++i) {
    if (const Keyframe* keyframe = keyframes_.Find(id)) {
      *cam_from_world = cam_from_ancestor * keyframe->cam_from_world;
      return true;
    }
    const KeyframeNode* culled = culled_.Find(id);
    if (!culled) return false;
    cam_from_ancestor = cam_from_ancestor * culled->cam_from_parent;
    id = culled->parent;
  }
  return false;
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

KeyframeId Map::LivingAncestor(KeyframeId id) const {
  for (int i = 0; i < kMaxTreeDepth; ++i) {
    if (keyframes_.Find(id)) return id;
    const KeyframeNode* culled = culled_.Find(id);
    if (!culled) return {};
    id = culled->parent;
  }
  return {};
}

std::vector<std::pair<KeyframeId, int>> Map::Covisible(KeyframeId id, int min_shared) const {
  std::vector<std::pair<KeyframeId, int>> result;
  const Keyframe* keyframe = Find(id);
  if (!keyframe) return result;
  for (const Covisibility& c : keyframe->covisible) {
    if (c.shared >= std::max(1, min_shared)) result.emplace_back(c.keyframe, c.shared);
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  return result;
}

std::vector<MapId> Map::Maps() const {
  std::vector<MapId> maps;
  for (const auto& [map, counts] : counts_) {
    if (counts.keyframes > 0) maps.push_back(map);
  }
  return maps;
}

Map::Counts Map::Count(MapId map) const {
  const auto at = counts_.find(map);
  return at == counts_.end() ? Counts() : at->second;
}

const ManhattanAxes* Map::Find(ManhattanId id) const {
  const auto at = manhattan_frames_.find(id);
  return at == manhattan_frames_.end() ? nullptr : &at->second;
}

std::vector<ManhattanAxes> Map::ManhattanFrames(MapId map) const {
  std::vector<ManhattanAxes> frames;
  for (const auto& [id, axes] : manhattan_frames_) {
    if (axes.map == map) frames.push_back(axes);
  }
  return frames;
}

// ---- What owner and replica do alike ----

void Map::NoteSession(KeyframeId keyframe, MapId map) {
  latest_keyframe_ = std::max(latest_keyframe_, keyframe);
  latest_session_ = std::max({latest_session_, keyframe.session(), map.session()});
}

void Map::AddKeyframe(const Keyframe& keyframe) {
  Keyframe& stored = keyframes_.Insert(keyframe.id);
  stored = keyframe;
  stored.culled = false;
  stored.covisible.clear();
  std::fill(stored.points.begin(), stored.points.end(), PointId());
  std::fill(stored.lines.begin(), stored.lines.end(), LineId());
  ++counts_[keyframe.map].keyframes;
  NoteSession(keyframe.id, keyframe.map);
}

void Map::AddCulled(const KeyframeNode& node) {
  KeyframeNode& stored = culled_.Insert(node.id);
  stored = node;
  stored.culled = true;
  NoteSession(node.id, node.map);
}

MapPoint& Map::AddPoint(PointId id, MapId map) {
  MapPoint& point = points_.Insert(id);
  point.id = id;
  point.map = map;
  ++CountOf(point);
  return point;
}

MapLine& Map::AddLine(LineId id, MapId map) {
  MapLine& line = lines_.Insert(id);
  line.id = id;
  line.map = map;
  ++CountOf(line);
  return line;
}

void Map::ChangeShared(Keyframe* keyframe, KeyframeId other, int change) {
  std::vector<Covisibility>& list = keyframe->covisible;
  const auto at =
      std::lower_bound(list.begin(), list.end(), other,
                       [](const Covisibility& c, KeyframeId id) { return c.keyframe < id; });
  if (at == list.end() || at->keyframe != other) {
    list.insert(at, {other, change});
  } else if ((at->shared += change) == 0) {
    list.erase(at);
  }
}

/// Of the keyframe with all others that observe the landmark.
template <class Landmark>
void Map::CountShared(const Landmark& landmark, KeyframeId keyframe_id, int change) {
  Keyframe& keyframe = Get(keyframe_id);
  for (const Observation& o : landmark.observations) {
    if (o.keyframe == keyframe_id) continue;
    ChangeShared(&keyframe, o.keyframe, change);
    ChangeShared(&Get(o.keyframe), keyframe_id, change);
  }
}

template <class Id>
bool Map::AddObservation(KeyframeId keyframe_id, int32_t feature, Id id) {
  Keyframe& keyframe = Get(keyframe_id);
  auto& landmark = Get(id);
  const auto at = LowerBound(landmark.observations, keyframe_id);
  if (at != landmark.observations.end() && at->keyframe == keyframe_id) return false;
  std::vector<Id>& slots = Slots(keyframe, id);
  if (feature >= std::ssize(slots)) slots.resize(static_cast<size_t>(feature) + 1);
  Id& slot = slots[static_cast<size_t>(feature)];
  if (slot.IsValid()) return false;
  slot = id;
  CountShared(landmark, keyframe_id, 1);
  landmark.observations.insert(at, {keyframe_id, feature});
  return true;
}

template <class Id>
bool Map::DropObservation(KeyframeId keyframe_id, Id id) {
  auto& landmark = Get(id);
  const auto at = LowerBound(landmark.observations, keyframe_id);
  if (at == landmark.observations.end() || at->keyframe != keyframe_id) return false;
  Slots(Get(keyframe_id), id)[static_cast<size_t>(at->feature)] = {};
  landmark.observations.erase(at);
  CountShared(landmark, keyframe_id, -1);
  return true;
}

template <class Id>
void Map::DropLandmark(Id id, Id replacement) {
  auto& landmark = Get(id);
  while (!landmark.observations.empty()) {
    DropObservation(landmark.observations.back().keyframe, id);
  }
  --CountOf(landmark);
  Table(id).Erase(id);
  if (replacement.IsValid()) ForwardsOf(id)[id] = replacement;
}

template bool Map::AddObservation(KeyframeId, int32_t, PointId);
template bool Map::AddObservation(KeyframeId, int32_t, LineId);
template bool Map::DropObservation(KeyframeId, PointId);
template bool Map::DropObservation(KeyframeId, LineId);
template void Map::DropLandmark(PointId, PointId);
template void Map::DropLandmark(LineId, LineId);

void Map::DropObservationsOf(KeyframeId id) {
  const Keyframe& keyframe = Get(id);
  for (const PointId point : std::vector(keyframe.points)) {
    if (point.IsValid()) DropObservation(id, point);
  }
  for (const LineId line : std::vector(keyframe.lines)) {
    if (line.IsValid()) DropObservation(id, line);
  }
}

void Map::MakeCulled(KeyframeId id, const SE3& cam_from_parent) {
  KeyframeNode node = Get(id);
  node.cam_from_parent = cam_from_parent;
  --counts_[node.map].keyframes;
  keyframes_.Erase(id);
  AddCulled(node);
}

void Map::DropMap(MapId map) {
  const auto drop = [map](auto* table) {
    for (const auto& each : *table) {
      if (each.map == map) table->Erase(each.id);
    }
  };
  drop(&points_);
  drop(&lines_);
  drop(&keyframes_);
  drop(&culled_);
  std::erase_if(manhattan_frames_, [map](const auto& frame) { return frame.second.map == map; });
  counts_.erase(map);
  erased_maps_.insert(map);
  latest_session_ = std::max(latest_session_, map.session());
}

void Map::Move(KeyframeId id, MapId map) {
  if (KeyframeNode* culled = culled_.Find(id)) {
    culled->map = map;
  } else {
    Keyframe& keyframe = Get(id);
    --counts_[keyframe.map].keyframes;
    ++counts_[map].keyframes;
    keyframe.map = map;
  }
  NoteSession(id, map);
}

template <class Id>
void Map::MoveLandmark(Id id, MapId map) {
  auto& landmark = Get(id);
  --CountOf(landmark);
  landmark.map = map;
  ++CountOf(landmark);
}

template void Map::MoveLandmark(PointId, MapId);
template void Map::MoveLandmark(LineId, MapId);

void Map::NoteMerger(MapId from, MapId into) {
  merged_maps_[from] = into;
  latest_session_ = std::max({latest_session_, from.session(), into.session()});
}

void Map::SetAxes(const ManhattanAxes& axes) { manhattan_frames_[axes.id] = axes; }

std::vector<LineId> Map::DropAxes(ManhattanId id) {
  std::vector<LineId> freed;
  if (manhattan_frames_.erase(id) == 0) return freed;
  for (const MapLine& line : lines_) {
    if (line.manhattan != id) continue;
    MapLine& mine = Get(line.id);
    mine.manhattan = {};
    mine.axis = -1;
    freed.push_back(line.id);
  }
  for (const Keyframe& keyframe : keyframes_) {
    if (keyframe.manhattan == id) Get(keyframe.id).manhattan = {};
  }
  return freed;
}

}  // namespace vpslam
