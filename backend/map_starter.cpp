#include "backend/map_starter.h"

#include "backend/keyframe_insertion.h"
#include "backend/local_ba.h"
#include "backend/manhattan_frames.h"
#include "backend/point_view.h"

namespace vpslam {
std::vector<PointId> StartMap(const MappingContext& context, const KeyframeProposal& first,
                              const KeyframeProposal& second, const LocalBaOptions& options) {
  OwnedMap* map = &context.map;
  map->Insert(ToKeyframe(first, KeyframeId(), context.bounds));
  map->Insert(ToKeyframe(second, first.id, context.bounds));
  std::vector<PointId> points;
  for (const InitialPoint& p : second.initial_points) {
    const PointId id = map->CreatePoint(second.map, second.id, p.position_in_world);
    map->Observe(first.id, p.feature_in_first, id);
    map->Observe(second.id, p.feature_in_second, id);
    UpdateDescriptor(id, map);
    points.push_back(id);
  }
  const ManhattanFrames none{ManhattanOptions()};
  AdjustLocally(context, second.id, none, options, options.max_iterations_to_start);
  return points;
}

}  // namespace vpslam
