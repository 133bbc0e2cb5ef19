#include "backend/point_fuser.h"

#include <algorithm>
#include <set>

#include "backend/landmark_join.h"
#include "backend/point_view.h"
#include "core/features/matcher.h"
#include "core/map/visibility.h"

namespace vpslam {
namespace {

class Fuser {
 public:
  Fuser(const MappingContext& context, const PointFuserOptions& options)
      : context_(context), options_(options) {}

  void FuseInto(KeyframeId keyframe_id, const std::vector<PointId>& points) {
    const auto& [camera, bounds, scales, map] = context_;
    const FrameObservation& seen = *map.Find(keyframe_id)->seen;
    for (const PointId id : points) {
      const MapPoint* point = map.Find(id);
      const Keyframe& keyframe = *map.Find(keyframe_id);
      if (!point || IsObservedBy(*point, keyframe_id)) continue;
      const auto view =
          PredictView(*point, keyframe.cam_from_world, keyframe.Center(), camera, bounds, scales);
      if (!view) continue;
      WindowQuery query;
      query.x_px = static_cast<float>(view->px.x());
      query.y_px = static_cast<float>(view->px.y());
      query.radius_px = static_cast<float>(options_.radius_px * scales.scale(view->octave));
      query.octaves = {std::max(0, view->octave - 1), view->octave + 1};
      query.max_distance = options_.max_distance;
      query.accuracy = &scales;
      const auto match = BestMatchInWindow(point->descriptor, query, seen.features, seen.grid);
      if (!match) continue;
      changed_.insert(ObserveOrFuse(keyframe_id, keyframe.points, match->index, id, &map));
    }
  }

  const std::set<PointId>& changed() const { return changed_; }

 private:
  const MappingContext& context_;
  const PointFuserOptions& options_;
  std::set<PointId> changed_;
};

std::vector<PointId> ValidPoints(const Keyframe& keyframe) {
  std::vector<PointId> result;
  std::copy_if(keyframe.points.begin(), keyframe.points.end(), std::back_inserter(result),
               [](PointId id) { return id.IsValid(); });
  return result;
}

std::vector<KeyframeId> Neighbourhood(KeyframeId id, const PointFuserOptions& options,
                                      const Map& map) {
  std::vector<KeyframeId> result;
  std::set<KeyframeId> seen{id};
  const auto add = [&](const auto& covisible, int limit) {
    for (const auto& [other, shared] : covisible) {
      if (limit-- <= 0) break;
      if (seen.insert(other).second) result.push_back(other);
    }
  };
  const auto first = map.Covisible(id, 1);
  add(first, options.neighbours);
  const size_t num_first = result.size();
  for (size_t i = 0; i < num_first; ++i) {
    add(map.Covisible(result[i], 1), options.second_neighbours);
  }
  return result;
}

}  // namespace

void FusePoints(const MappingContext& context, KeyframeId id, const PointFuserOptions& options) {
  OwnedMap* map = &context.map;
  Fuser fuser(context, options);
  const std::vector<KeyframeId> targets = Neighbourhood(id, options, *map);
  for (const KeyframeId target : targets) fuser.FuseInto(target, ValidPoints(*map->Find(id)));
  std::set<PointId> candidates;
  for (const KeyframeId target : targets) {
    for (const PointId point : ValidPoints(*map->Find(target))) candidates.insert(point);
  }
  fuser.FuseInto(id, {candidates.begin(), candidates.end()});
  for (const PointId point : fuser.changed()) {
    UpdateView(point, context.scales, map);
    UpdateDescriptor(point, map);
  }
}

}  // namespace vpslam
