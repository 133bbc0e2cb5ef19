#include "frontend/pose_tracker.h"

#include "core/base/stopwatch.h"
#include "frontend/line_tracking.h"

namespace vpslam {

bool PoseTracker::TrackFrom(const Frame& last, const std::optional<SE3>& velocity,
                            Frame* frame) const {
  return TrackWithMotion(last, velocity, frame) || TrackWithKeyframe(last, frame);
}

bool PoseTracker::TrackWithMotion(const Frame& last, const std::optional<SE3>& velocity,
                                  Frame* frame) const {
  const auto& motion = options_.motion;
  const SE3 predicted = velocity ? *velocity * last.cam_from_world : last.cam_from_world;
  for (const double factor : {1.0, 2.0}) {
    frame->cam_from_world = predicted;
    const double window_px = factor * motion.window_px;
    int matches = MatchLastFrame(context_, last, window_px, motion, frame);
    matches += MatchLines(context_, LivingLines(context_.map, last.map_lines), window_px,
                          options_.lines, frame);
    if (matches < motion.min_matches) continue;
    OptimizeFrame(context_, options_.pose, frame);
    if (frame->Support() >= motion.min_inliers) return true;
  }
  return false;
}

bool PoseTracker::TrackWithKeyframe(const Frame& last, Frame* frame) const {
  frame->cam_from_world = last.cam_from_world;
  KeyframeId keyframe = context_.map.LivingAncestor(last.reference);
  if (!keyframe.IsValid()) keyframe = context_.map.LivingAncestor(reference_in_map_);
  if (MatchKeyframe(context_, keyframe, frame) < options_.motion.min_matches) return false;
  OptimizeFrame(context_, options_.pose, frame);
  return frame->Support() >= options_.motion.min_inliers;
}

bool PoseTracker::TrackLocalMap(MapId map, std::mt19937_64& rng, Frame* frame, LocalMap* local) {
  *local = CollectLocalMap(context_.map, *frame, options_.local_map);
  std::vector<PointId> visible;
  MatchLocalMap(context_, *local, options_.local_map, 1.0, frame, &visible);
  MatchLines(context_, local->lines, options_.lines.window_px, options_.lines, frame);
  OptimizeFrame(context_, options_.pose, frame, MeasuredRotation(map, *frame));
  if (frame->Support() < options_.local_map.min_inliers) return false;
  Overwrite(rng, frame);
  for (const PointId id : visible) ++sightings_[id].visible;
  for (const PointId id : frame->points) {
    if (id.IsValid()) ++sightings_[id].found;
  }
  reference_in_map_ = local->reference;
  return HangOn(context_.map, local->reference, frame);
}

std::optional<RotationMeasurement> PoseTracker::MeasuredRotation(MapId map,
                                                                 const Frame& frame) const {
  const auto world_from_manhattan = context_.map.WorldFromManhattan(map);
  if (options_.rotation.mode != RotationMode::kFused || !frame.lines || !world_from_manhattan) {
    return std::nullopt;
  }
  return MeasureRotation(*frame.lines, *world_from_manhattan, frame.cam_from_world.rotation,
                         options_.rotation);
}

void PoseTracker::Overwrite(std::mt19937_64& rng, Frame* frame) {
  Stopwatch stopwatch;
  if (options_.rotation.mode == RotationMode::kPaper && frame->lines) {
    paper_rotation_.Refine(*frame->lines, &frame->cam_from_world.rotation);
    frame->times.rotation_ms = stopwatch.Lap_ms();
  }
  if (options_.translation != TranslationMode::kOff) {
    RefineTranslation(context_, options_.translation, options_.local_map.min_inliers, rng, frame);
    frame->times.translation_ms = stopwatch.Lap_ms();
  }
}

std::vector<PointSighting> PoseTracker::TakeSightings() {
  std::vector<PointSighting> sightings;
  sightings.reserve(sightings_.size());
  for (const auto& [id, counts] : sightings_) {
    sightings.push_back({id, counts.visible, counts.found});
  }
  sightings_.clear();
  return sightings;
}

}  // namespace vpslam
