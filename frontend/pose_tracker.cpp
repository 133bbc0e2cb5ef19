#include "frontend/pose_tracker.h"

#include "core/base/stopwatch.h"
#include "core/geometry/so3.h"
#include "frontend/line_tracking.h"

namespace vpslam {

bool PoseTracker::TrackFrom(const Frame& last, const std::optional<SE3>& velocity,
                            Frame* frame) const {
  return TrackWithMotion(last, velocity, frame) || TrackWithKeyframe(last, frame);
}

bool PoseTracker::TrackWithMotion(const Frame& last, const std::optional<SE3>& velocity,
                                  Frame* frame) const {
  const auto& motion = options_.motion;
  const SE3& from = last.placement.cam_from_world;
  const SE3 predicted = velocity ? *velocity * from : from;
  for (const double factor : {1.0, 2.0}) {
    const double window_px = factor * motion.window_px;
    int matches = MatchLastFrame(context_, last, predicted, window_px, motion, frame);
    matches += MatchLines(context_, LivingLines(context_.map, last.placement.lines()), window_px,
                          options_.lines, frame);
    if (matches < motion.min_matches) continue;
    OptimizeFrame(context_, options_.pose, frame);
    if (frame->placement.Support() >= motion.min_inliers) return true;
  }
  return false;
}

bool PoseTracker::TrackWithKeyframe(const Frame& last, Frame* frame) const {
  KeyframeId keyframe = context_.map.LivingAncestor(last.placement.reference);
  if (!keyframe.IsValid()) keyframe = context_.map.LivingAncestor(reference_in_map_);
  const int matches = MatchKeyframe(context_, keyframe, last.placement.cam_from_world, frame);
  if (matches < options_.motion.min_matches) return false;
  OptimizeFrame(context_, options_.pose, frame);
  return frame->placement.Support() >= options_.motion.min_inliers;
}

bool PoseTracker::TrackLocalMap(std::mt19937_64& rng, Frame* frame, LocalMap* local) {
  *local = CollectLocalMap(context_.map, *frame, options_.local_map);
  std::vector<PointId> visible;
  MatchLocalMap(context_, *local, options_.local_map, 1.0, frame, &visible);
  MatchLines(context_, local->lines, options_.lines.window_px, options_.lines, frame);
  OptimizeFrame(context_, options_.pose, frame, MeasuredRotation(*frame));
  if (frame->placement.Support() < options_.local_map.min_inliers) return false;
  Overwrite(rng, frame);
  for (const PointId id : visible) ++sightings_[id].visible;
  for (const PointId id : frame->placement.points()) {
    if (id.IsValid()) ++sightings_[id].found;
  }
  reference_in_map_ = local->reference;
  return frame->placement.HangOn(context_.map, local->reference);
}

std::optional<RotationMeasurement> PoseTracker::MeasuredRotation(const Frame& frame) const {
  std::optional<RotationMeasurement> nearest;
  if (options_.rotation.mode != RotationMode::kFused || !frame.seen->lines) return nearest;
  const Eigen::Quaterniond& predicted = frame.placement.cam_from_world.rotation;
  for (const ManhattanAxes& axes : context_.map.ManhattanFrames(frame.placement.map())) {
    const std::optional<RotationMeasurement> measured = MeasureRotation(
        *frame.seen->lines, axes.world_from_manhattan, predicted, options_.rotation);
    if (!measured) continue;
    if (!nearest || AngleBetween_rad(measured->cam_from_world, predicted) <
                        AngleBetween_rad(nearest->cam_from_world, predicted)) {
      nearest = measured;
    }
  }
  return nearest;
}

void PoseTracker::Overwrite(std::mt19937_64& rng, Frame* frame) {
  Stopwatch stopwatch;
  if (options_.rotation.mode == RotationMode::kPaper && frame->seen->lines) {
    paper_rotation_.Refine(*frame->seen->lines, &frame->placement.cam_from_world.rotation);
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
