#include "backend/map_starter.h"

#include "backend/local_ba.h"
#include "backend/manhattan_frame.h"
#include "backend/point_view.h"

namespace vpslam {
namespace {

Keyframe ToKeyframe(const KeyframeProposal& proposal, KeyframeId parent) {
  Keyframe keyframe;
  keyframe.id = proposal.id;
  keyframe.map = proposal.map;
  keyframe.frame_seq = proposal.frame_seq;
  keyframe.stamp_us = proposal.stamp_us;
  keyframe.cam_from_world = proposal.cam_from_world;
  keyframe.parent = parent;
  keyframe.points.resize(proposal.features.size());
  return keyframe;
}

}  // namespace

std::vector<PointId> StartMap(const KeyframeProposal& first, const KeyframeProposal& second,
                              const Camera& camera, const ScalePyramid& scales,
                              const KeyframeStore& store, const LocalBaOptions& options, Map* map) {
  map->Insert(ToKeyframe(first, KeyframeId()));
  map->Insert(ToKeyframe(second, first.id));
  std::vector<PointId> points;
  for (const InitialPoint& p : second.initial_points) {
    const PointId id = map->CreatePoint(second.map, second.id, p.position_in_world);
    map->Observe(first.id, p.feature_in_first, id);
    map->Observe(second.id, p.feature_in_second, id);
    UpdateDescriptor(id, store, map);
    points.push_back(id);
  }
  const ManhattanFrame none{ManhattanOptions()};
  AdjustLocally(second.id, camera, scales, store, none, options, options.max_iterations_to_start,
                map);
  return points;
}

}  // namespace vpslam
