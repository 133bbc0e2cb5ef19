#include "frontend/keyframe_policy.h"

#include <algorithm>

namespace vpslam {
namespace {

/// Points and lines of the keyframe that the map is sure of.
int TrackedLandmarks(const Map& map, KeyframeId id, size_t min_observations) {
  const Keyframe* keyframe = map.Find(id);
  int count = 0;
  if (!keyframe) return count;
  const auto add = [&](const auto& ids) {
    for (const auto landmark_id : ids) {
      const auto* landmark = map.Find(landmark_id);
      count += landmark && landmark->observations.size() >= min_observations;
    }
  };
  add(keyframe->points);
  add(keyframe->lines);
  return count;
}

}  // namespace

bool IsKeyframe(const Frame& frame, KeyframeId reference, const EarlierKeyframes& earlier,
                const Map& map, const KeyframePolicyOptions& options) {
  const int support = frame.Support();
  if (earlier.frames_since < options.min_frames || support < options.min_inliers) return false;
  const MapId map_id = map.Find(reference) ? map.Find(reference)->map : MapId();
  // A young map has no point with three observations yet.
  const size_t min_observations = map.NumKeyframes(map_id) <= 2 ? 2 : 3;
  const int tracked = TrackedLandmarks(map, reference, min_observations);
  if (support >= options.max_tracked_ratio * tracked) return false;
  const bool weak =
      support < std::max(options.weak_tracked_ratio * tracked, 1.0 * options.weak_support);
  return earlier.unanswered <
         (weak ? options.max_unanswered_when_weak : std::max(1, options.max_unanswered));
}

}  // namespace vpslam
