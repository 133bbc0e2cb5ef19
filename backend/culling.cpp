#include "backend/culling.h"

#include <algorithm>
#include <cmath>

namespace vpslam {

void PointProbation::Add(PointId point, int keyframe_count) {
  records_[point].created_at = keyframe_count;
}

void PointProbation::Count(const PointSighting& sighting) {
  const auto at = records_.find(sighting.point);
  if (at == records_.end()) return;
  at->second.visible += sighting.visible;
  at->second.found += sighting.found;
}

void PointProbation::Cull(int keyframe_count, OwnedMap* map) {
  for (auto at = records_.begin(); at != records_.end();) {
    const auto& [id, record] = *at;
    const MapPoint* point = map->Find(id);
    const int age = keyframe_count - record.created_at;
    bool done = !point || age > options_.probation_keyframes;
    if (point) {
      const auto observations = static_cast<int>(point->observations.size());
      const bool missed = record.found < options_.min_found_ratio * record.visible;
      const bool lonely =
          age >= options_.probation_keyframes - 1 && observations < options_.min_observations;
      if (missed || lonely) {
        map->Erase(id);
        done = true;
      }
    }
    at = done ? records_.erase(at) : std::next(at);
  }
}

void LineProbation::Cull(int keyframe_count, OwnedMap* map) {
  for (auto at = created_at_.begin(); at != created_at_.end();) {
    const auto& [id, created_at] = *at;
    const MapLine* line = map->Find(id);
    const bool due = keyframe_count - created_at >= options_.probation_keyframes - 1;
    if (line && due && static_cast<int>(line->observations.size()) < options_.min_observations) {
      map->Erase(id);
    }
    at = !line || due ? created_at_.erase(at) : std::next(at);
  }
}

namespace {

int OctaveOf(const Observation& o, const Map& map) {
  return map.Find(o.keyframe)->seen->features.keypoints[o.feature].octave;
}

int NumPoints(const Keyframe& keyframe, const Map& map) {
  return static_cast<int>(std::count_if(keyframe.points.begin(), keyframe.points.end(),
                                        [&](PointId id) { return map.Find(id); }));
}

/// How many other keyframes have to see a point, for this keyframe not to be needed for it. More
/// than there are where a keyframe shows little, so it stays a double.
double NeededObservers(int num_points, const Keyframe& keyframe, const CullingOptions& options) {
  const auto num_lines = std::count_if(keyframe.lines.begin(), keyframe.lines.end(),
                                       [](LineId id) { return id.IsValid(); });
  const double seen = num_points + options.points_per_line * static_cast<double>(num_lines);
  const double scarcity = options.plenty_points / std::max(1.0, seen);
  return std::floor(options.min_other_observers *
                    std::pow(std::max(1.0, scarcity), options.scarcity_power));
}

bool IsRedundant(const Keyframe& keyframe, const CullingOptions& options, const Map& map) {
  const int points = NumPoints(keyframe, map);
  const double needed = NeededObservers(points, keyframe, options);
  int redundant = 0;
  for (size_t i = 0; i < keyframe.points.size(); ++i) {
    const MapPoint* point = map.Find(keyframe.points[i]);
    if (!point || static_cast<double>(point->observations.size()) <= needed) continue;
    const int octave = keyframe.seen->features.keypoints[i].octave;
    int others = 0;
    for (const Observation& o : point->observations) {
      if (o.keyframe != keyframe.id && OctaveOf(o, map) <= octave + 1) ++others;
      if (others >= needed) break;
    }
    redundant += others >= needed;
  }
  return redundant > options.max_redundant_share * points;
}

}  // namespace

int CullKeyframes(KeyframeId id, const CullingOptions& options, OwnedMap* map) {
  int culled = 0;
  for (const auto& [other, shared] : map->Covisible(id, 1)) {
    const Keyframe& keyframe = *map->Find(other);
    if (!keyframe.parent.IsValid()) continue;
    if (!IsRedundant(keyframe, options, *map)) continue;
    map->Cull(other);
    ++culled;
  }
  return culled;
}

}  // namespace vpslam
