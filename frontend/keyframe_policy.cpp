#include "frontend/keyframe_policy.h"

namespace vpslam {
namespace {

/// Points of the keyframe that the map is sure of.
int TrackedPoints(const Map& map, KeyframeId id, size_t min_observations) {
  const Keyframe* keyframe = map.Find(id);
  int count = 0;
  if (!keyframe) return count;
  for (const PointId point_id : keyframe->points) {
    const MapPoint* point = map.Find(point_id);
    count += point && point->observations.size() >= min_observations;
  }
  return count;
}

}  // namespace

bool IsKeyframe(const Frame& frame, KeyframeId reference, int frames_since, const Map& map,
                const KeyframePolicyOptions& options) {
  if (frames_since < options.min_frames || frame.inliers < options.min_inliers) return false;
  const MapId map_id = map.Find(reference) ? map.Find(reference)->map : MapId();
  // A young map has no point with three observations yet.
  const size_t min_observations = map.NumKeyframes(map_id) <= 2 ? 2 : 3;
  return frame.inliers <
         options.max_tracked_ratio * TrackedPoints(map, reference, min_observations);
}

}  // namespace vpslam
