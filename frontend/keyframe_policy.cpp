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

/// How a frame is tracked, beside what its reference shows.
struct Tracking {
  bool is_less = false;  ///< than nearly all of it
  bool is_weak = false;
};

Tracking TrackingOf(const Frame& frame, KeyframeId reference, const Map& map,
                    const KeyframePolicyOptions& options) {
  const MapId map_id = map.Find(reference) ? map.Find(reference)->map : MapId();
  // A young map has no point with three observations yet.
  const size_t min_observations = map.NumKeyframes(map_id) <= 2 ? 2 : 3;
  const int tracked = TrackedLandmarks(map, reference, min_observations);
  const int support = frame.placement.Support();
  const bool is_less = support < options.max_tracked_ratio * tracked;
  return {is_less, is_less && support < std::max(options.weak_tracked_ratio * tracked,
                                                 1.0 * options.weak_support)};
}

}  // namespace

bool IsWeaklyTracked(const Frame& frame, KeyframeId reference, const Map& map,
                     const KeyframePolicyOptions& options) {
  return TrackingOf(frame, reference, map, options).is_weak;
}

bool IsKeyframe(const Frame& frame, KeyframeId reference, const EarlierKeyframes& earlier,
                const Map& map, const KeyframePolicyOptions& options) {
  if (earlier.frames_since < options.min_frames ||
      frame.placement.Support() < options.min_inliers) {
    return false;
  }
  const Tracking tracking = TrackingOf(frame, reference, map, options);
  return tracking.is_less &&
         earlier.unanswered < (tracking.is_weak ? options.max_unanswered_when_weak
                                                : std::max(1, options.max_unanswered));
}

KeyframeProposal MakeProposal(const Frame& frame, KeyframeId id) {
  KeyframeProposal proposal;
  proposal.id = id;
  proposal.map = frame.placement.map();
  proposal.frame_seq = frame.seen->frame_seq;
  proposal.stamp_us = frame.seen->stamp_us;
  proposal.cam_from_world = frame.placement.cam_from_world;
  proposal.reference = frame.placement.reference;
  proposal.features = frame.seen->features;
  proposal.points = frame.placement.points();
  if (frame.seen->lines) proposal.lines = *frame.seen->lines;
  proposal.map_lines = frame.placement.lines();
  return proposal;
}

}  // namespace vpslam
