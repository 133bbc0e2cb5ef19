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
  Fuser(const Camera& camera, const Camera::Bounds& bounds, const ScalePyramid& scales,
        const KeyframeStore& store, const PointFuserOptions& options, Map* map)
      : camera_(camera),
        bounds_(bounds),
        scales_(scales),
        store_(store),
        options_(options),
        map_(map) {}

  void FuseInto(KeyframeId keyframe_id, const std::vector<PointId>& points) {
    const KeyframeFeatures& stored = store_.at(keyframe_id);
    for (const PointId id : points) {
      const MapPoint* point = map_->Find(id);
      const Keyframe& keyframe = *map_->Find(keyframe_id);
      if (!point || IsObservedBy(*point, keyframe_id)) continue;
      const auto view = PredictView(*point, keyframe.cam_from_world, keyframe.Center(), camera_,
                                    bounds_, scales_);
      if (!view) continue;
      WindowQuery query;
      query.x_px = static_cast<float>(view->px.x());
      query.y_px = static_cast<float>(view->px.y());
      query.radius_px = static_cast<float>(options_.radius_px * scales_.scale(view->octave));
      query.octaves = {std::max(0, view->octave - 1), view->octave + 1};
      query.max_distance = options_.max_distance;
      query.accuracy = &scales_;
      const auto match = BestMatchInWindow(point->descriptor, query, stored.features, stored.grid);
      if (!match) continue;
      changed_.insert(ObserveOrFuse(keyframe_id, keyframe.points, match->index, id, map_));
    }
  }

  const std::set<PointId>& changed() const { return changed_; }

 private:
  const Camera& camera_;
  const Camera::Bounds& bounds_;
  const ScalePyramid& scales_;
  const KeyframeStore& store_;
  const PointFuserOptions& options_;
  Map* map_;
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

void FusePoints(KeyframeId id, const Camera& camera, const Camera::Bounds& bounds,
                const ScalePyramid& scales, const KeyframeStore& store,
                const PointFuserOptions& options, Map* map) {
  Fuser fuser(camera, bounds, scales, store, options, map);
  const std::vector<KeyframeId> targets = Neighbourhood(id, options, *map);
  for (const KeyframeId target : targets) fuser.FuseInto(target, ValidPoints(*map->Find(id)));
  std::set<PointId> candidates;
  for (const KeyframeId target : targets) {
    for (const PointId point : ValidPoints(*map->Find(target))) candidates.insert(point);
  }
  fuser.FuseInto(id, {candidates.begin(), candidates.end()});
  for (const PointId point : fuser.changed()) {
    UpdateView(point, store, scales, map);
    UpdateDescriptor(point, store, map);
  }
}

}  // namespace vpslam
