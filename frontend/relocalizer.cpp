#include "frontend/relocalizer.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/geometry/pnp.h"
#include "frontend/local_map.h"

namespace vpslam {
namespace {

/// A pose from the matches at hand, some of them wrong; wrong ones are taken away.
bool SolvePose(const TrackingContext& context, std::mt19937_64& rng, Frame* frame) {
  std::vector<PnpMatch> matches;
  std::vector<int> features;
  for (int i = 0; i < frame->features.size(); ++i) {
    const MapPoint* point = context.map.Find(frame->points[i]);
    if (!point) continue;
    const Keypoint& keypoint = frame->features.keypoints[i];
    matches.push_back(
        {point->position, keypoint.Position(), context.scales.sigma_px(keypoint.octave)});
    features.push_back(i);
  }
  const auto pose = EstimatePnp(context.camera, matches, PnpOptions(), rng);
  if (!pose) return false;
  frame->cam_from_world = pose->cam_from_world;
  for (size_t i = 0; i < features.size(); ++i) {
    if (!pose->inlier[i]) frame->points[features[i]] = PointId();
  }
  return true;
}

/// The pose from a few matches may be crude: look farther around first.
bool Refine(const TrackingContext& context, const TrackerOptions& options, Frame* frame) {
  for (const double radius_factor : {4.0, 1.0}) {
    const LocalMap local = CollectLocalMap(context.map, *frame, options.local_map);
    std::vector<PointId> visible;
    MatchLocalMap(context, local, options.local_map, radius_factor, frame, &visible);
    if (OptimizeFrame(context, options.pose, frame) < options.motion.min_inliers) return false;
  }
  return frame->inliers >= options.local_map.min_inliers_after_loss;
}

}  // namespace

bool Relocalize(const TrackingContext& context, MapId map, const RelocalizerOptions& options,
                const TrackerOptions& tracking, std::mt19937_64& rng, Frame* frame) {
  std::vector<std::pair<int, KeyframeId>> candidates;
  for (int32_t i = 0; i < context.map.keyframe_end(); ++i) {
    const KeyframeId id(i);
    const Keyframe* keyframe = context.map.Find(id);
    if (!keyframe || keyframe->map != map) continue;
    const int matches = MatchKeyframe(context, id, frame);
    if (matches >= options.min_matches) candidates.emplace_back(-matches, id);
  }
  std::sort(candidates.begin(), candidates.end());
  if (static_cast<int>(candidates.size()) > options.max_candidates) {
    candidates.resize(options.max_candidates);
  }
  for (const auto& [matches, id] : candidates) {
    MatchKeyframe(context, id, frame);
    if (SolvePose(context, rng, frame) && Refine(context, tracking, frame)) return true;
  }
  frame->ForgetMatches();
  return false;
}

}  // namespace vpslam
