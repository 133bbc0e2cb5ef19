#include "frontend/relocalizer.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/features/matcher.h"
#include "core/geometry/pnp.h"
#include "core/map/votes.h"
#include "frontend/local_map.h"

namespace vpslam {
namespace {

/// The frame's features against the points of a keyframe and of those that share most with it: one
/// keyframe alone shows only part of what a camera nearby sees.
int MatchPlace(const TrackingContext& context, KeyframeId keyframe_id, int neighbours,
               Frame* frame) {
  frame->PlaceIn(context.map.Find(keyframe_id)->map, SE3());
  std::vector<KeyframeId> keyframes{keyframe_id};
  for (const auto& [other, shared] : context.map.Covisible(keyframe_id, 15)) {
    if (static_cast<int>(keyframes.size()) > neighbours) break;
    keyframes.push_back(other);
  }
  Marks seen(context.map.points());
  std::vector<const MapPoint*> points;
  std::vector<Descriptor> descriptors;
  for (const KeyframeId id : keyframes) {
    for (const PointId point_id : context.map.Find(id)->points) {
      const MapPoint* point = context.map.Find(point_id);
      if (!point || !seen.Insert(point_id)) continue;
      points.push_back(point);
      descriptors.push_back(point->descriptor);
    }
  }
  int count = 0;
  for (const Match& m : MatchByDescriptor(descriptors, frame->seen->features.descriptors)) {
    count += frame->placement.Match(m.second, *points[m.first]);
  }
  return count;
}

/// A pose from the matches at hand, some of them wrong; wrong ones are taken away.
bool SolvePose(const TrackingContext& context, std::mt19937_64& rng, Frame* frame) {
  std::vector<PnpMatch> matches;
  std::vector<int> features;
  for (int i = 0; i < frame->seen->num_features(); ++i) {
    const MapPoint* point = context.map.Find(frame->placement.points()[i]);
    if (!point) continue;
    const Keypoint& keypoint = frame->seen->features.keypoints[i];
    matches.push_back(
        {point->position, keypoint.Position(), context.scales.sigma_px(keypoint.octave)});
    features.push_back(i);
  }
  const auto pose = EstimatePnp(context.camera, matches, PnpOptions(), rng);
  if (!pose) return false;
  frame->placement.cam_from_world = pose->cam_from_world;
  for (size_t i = 0; i < features.size(); ++i) {
    if (!pose->inlier[i]) frame->placement.UnmatchPoint(features[i]);
  }
  return true;
}

}  // namespace

/// The pose from a few matches may be crude: look farther around first.
bool Relocalizer::Refine(const TrackingContext& context, const RelocalizationGate& gate,
                         Frame* frame) const {
  size_t num_visible = 0;
  for (const double radius_factor : {4.0, 1.0}) {
    const LocalMap local = CollectLocalMap(context.map, *frame, options_.local_map);
    std::vector<PointId> visible;
    MatchLocalMap(context, local, options_.local_map, radius_factor, frame, &visible);
    if (OptimizeFrame(context, options_.pose, frame) < options_.motion.min_inliers) return false;
    num_visible = visible.size();
  }
  const Placement& placement = frame->placement;
  const bool is_near =
      gate.Allow(context.map, placement.map(), placement.cam_from_world, frame->seen->stamp_us);
  const double min_share =
      is_near ? options_.relocalizer.min_found_share : options_.relocalizer.min_found_share_far;
  return placement.inliers >= options_.local_map.min_inliers_after_loss &&
         placement.inliers >= min_share * static_cast<double>(num_visible);
}

bool Relocalizer::TryPlace(const TrackingContext& context, KeyframeId keyframe,
                           const RelocalizationGate& gate, std::mt19937_64& rng,
                           Frame* frame) const {
  const RelocalizerOptions& options = options_.relocalizer;
  return MatchPlace(context, keyframe, options.neighbours, frame) >= options.min_matches &&
         SolvePose(context, rng, frame) && Refine(context, gate, frame);
}

bool Relocalizer::Find(const TrackingContext& context, const std::vector<MapId>& except,
                       const RelocalizationGate& gate, std::mt19937_64& rng, Frame* frame) {
  index_.Update(context.map, except);
  const auto places = index_.Query(context.map, frame->seen->features.descriptors,
                                   options_.relocalizer.max_candidates);
  for (const auto& [keyframe, votes] : places) {
    if (TryPlace(context, keyframe, gate, rng, frame)) return true;
  }
  frame->placement = Placement();
  return false;
}

}  // namespace vpslam
