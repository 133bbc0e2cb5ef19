#include "frontend/frame_tracking.h"

#include <algorithm>

#include "core/estimation/line_residual.h"
#include "core/estimation/point_residual.h"
#include "core/features/corner_accuracy.h"
#include "core/features/matcher.h"

namespace vpslam {
namespace {

/// Keeps matches that turned as most did; see core/features/rotation_consistency.h.
int DropRotationOutliers(const std::vector<float>& last_angles_rad,
                         const std::vector<int>& features, Frame* frame) {
  std::vector<float> differences;
  for (size_t i = 0; i < features.size(); ++i) {
    differences.push_back(last_angles_rad[i] - frame->features.keypoints[features[i]].angle_rad);
  }
  const std::vector<uint8_t> keep = FindRotationConsistent(differences);
  int kept = 0;
  for (size_t i = 0; i < features.size(); ++i) {
    if (keep[i]) {
      ++kept;
    } else {
      frame->points[features[i]] = PointId();
    }
  }
  return kept;
}

}  // namespace

int MatchLastFrame(const TrackingContext& context, const Frame& last, double window_px,
                   const MotionTrackingOptions& options, Frame* frame) {
  frame->ForgetMatches();
  std::vector<uint8_t> taken(frame->features.size(), 0);
  // Two features of the last frame may show one point by now: theirs were fused since.
  std::vector<uint8_t> found(context.map.point_end(), 0);
  std::vector<float> last_angles_rad;
  std::vector<int> matched;
  for (size_t i = 0; i < last.points.size(); ++i) {
    if (!last.points[i].IsValid()) continue;
    const PointId id = context.map.Resolve(last.points[i]);
    const MapPoint* point = context.map.Find(id);
    if (!point || found[id.value]) continue;
    const Eigen::Vector3d x = frame->cam_from_world * point->position;
    if (x.z() < kMinDepth) continue;
    const Eigen::Vector2d px = context.camera.Project(x);
    if (!context.bounds.Contains(px)) continue;
    const Keypoint& last_keypoint = last.features.keypoints[i];
    WindowQuery query;
    query.x_px = static_cast<float>(px.x());
    query.y_px = static_cast<float>(px.y());
    query.radius_px = static_cast<float>(window_px * context.scales.scale(last_keypoint.octave));
    query.octaves = {std::max(0, last_keypoint.octave - 1), last_keypoint.octave + 1};
    query.max_distance = options.max_distance;
    const auto match =
        BestMatchInWindow(point->descriptor, query, frame->features, frame->grid, taken);
    if (!match) continue;
    taken[match->index] = 1;
    found[id.value] = 1;
    frame->points[match->index] = id;
    last_angles_rad.push_back(last_keypoint.angle_rad);
    matched.push_back(match->index);
  }
  return DropRotationOutliers(last_angles_rad, matched, frame);
}

int MatchKeyframe(const TrackingContext& context, KeyframeId keyframe_id, Frame* frame) {
  frame->ForgetMatches();
  const Keyframe* keyframe = context.map.Find(keyframe_id);
  if (!keyframe) return 0;
  std::vector<PointId> ids;
  std::vector<Descriptor> descriptors;
  for (const PointId id : keyframe->points) {
    if (const MapPoint* point = context.map.Find(id)) {
      ids.push_back(id);
      descriptors.push_back(point->descriptor);
    }
  }
  const std::vector<Match> matches = MatchByDescriptor(descriptors, frame->features.descriptors);
  for (const Match& m : matches) frame->points[m.second] = ids[m.first];
  return static_cast<int>(matches.size());
}

PoseMeasurements Measure(const TrackingContext& context, Frame* frame, std::vector<int>* features,
                         std::vector<int>* segments) {
  PoseMeasurements measurements;
  for (int i = 0; i < frame->features.size(); ++i) {
    const MapPoint* point = context.map.Find(frame->points[i]);
    if (!point) {
      frame->points[i] = PointId();
      continue;
    }
    const Keypoint& keypoint = frame->features.keypoints[i];
    measurements.points.push_back(
        {point->position, keypoint.Position(), CornerSqrtInformation(keypoint, context.scales)});
    features->push_back(i);
  }
  for (size_t i = 0; i < frame->map_lines.size(); ++i) {
    const MapLine* line = context.map.Find(frame->map_lines[i]);
    if (!line) {
      frame->map_lines[i] = LineId();
      continue;
    }
    const LineSegment& segment = frame->lines->lines[i];
    const double sigma_px = LineSigma_px(segment.sigma_px);
    measurements.lines.push_back({line->start, line->end, segment.start_px.cast<double>(),
                                  segment.end_px.cast<double>(), 1 / (sigma_px * sigma_px)});
    segments->push_back(static_cast<int>(i));
  }
  return measurements;
}

int OptimizeFrame(const TrackingContext& context, const PoseOptimizerOptions& options, Frame* frame,
                  const std::optional<RotationMeasurement>& rotation) {
  std::vector<int> features, segments;
  PoseMeasurements measurements = Measure(context, frame, &features, &segments);
  measurements.rotation = rotation;
  const PoseEstimate estimate =
      OptimizePose(context.camera, measurements, frame->cam_from_world, options);
  frame->cam_from_world = estimate.cam_from_world;
  frame->covariance = estimate.covariance;
  frame->matches = static_cast<int>(measurements.points.size());
  frame->inliers = estimate.num_inliers;
  for (size_t i = 0; i < features.size(); ++i) {
    if (!estimate.inliers[i]) frame->points[features[i]] = PointId();
  }
  frame->line_inliers = estimate.num_line_inliers;
  for (size_t i = 0; i < segments.size(); ++i) {
    if (!estimate.line_inliers[i]) frame->map_lines[segments[i]] = LineId();
  }
  return frame->inliers;
}

bool HangOn(const Map& map, KeyframeId reference, Frame* frame) {
  frame->reference = reference;
  if (!map.Hang(reference, frame->cam_from_world, &frame->cam_from_reference)) return false;
  frame->unit = map.FindEvenCulled(reference)->unit;
  return true;
}

bool FollowMap(const Map& map, Frame* frame, SE3* velocity) {
  if (!map.Place(frame->reference, frame->cam_from_reference, &frame->cam_from_world)) return false;
  const Keyframe& reference = *map.FindEvenCulled(frame->reference);
  if (velocity) velocity->translation *= reference.unit / frame->unit;
  frame->unit = reference.unit;
  // A frame that became a keyframe was given new points since.
  if (!reference.culled && reference.frame_seq == frame->seq) {
    frame->points = reference.points;
    frame->points.resize(frame->features.size());
    frame->map_lines = reference.lines;
  }
  return true;
}

}  // namespace vpslam
