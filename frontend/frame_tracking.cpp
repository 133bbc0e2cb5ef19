#include "frontend/frame_tracking.h"

#include <algorithm>

#include "core/estimation/line_residual.h"
#include "core/estimation/point_residual.h"
#include "core/features/corner_accuracy.h"
#include "core/features/matcher.h"
#include "core/map/votes.h"

namespace vpslam {
namespace {

/// Keeps matches that turned as most did; see core/features/rotation_consistency.h.
int DropRotationOutliers(const std::vector<float>& last_angles_rad,
                         const std::vector<int>& features, Frame* frame) {
  std::vector<float> differences;
  for (size_t i = 0; i < features.size(); ++i) {
    differences.push_back(last_angles_rad[i] -
                          frame->seen->features.keypoints[features[i]].angle_rad);
  }
  const std::vector<uint8_t> keep = FindRotationConsistent(differences);
  int kept = 0;
  for (size_t i = 0; i < features.size(); ++i) {
    if (keep[i]) {
      ++kept;
    } else {
      frame->placement.UnmatchPoint(features[i]);
    }
  }
  return kept;
}

}  // namespace

int MatchLastFrame(const TrackingContext& context, const Frame& last, const SE3& cam_from_world,
                   double window_px, const MotionTrackingOptions& options, Frame* frame) {
  frame->PlaceIn(last.placement.map(), cam_from_world);
  const FrameObservation& seen = *frame->seen;
  const std::vector<PointId>& last_points = last.placement.points();
  std::vector<uint8_t> taken(seen.num_features(), 0);
  // Two features of the last frame may show one point by now: theirs were fused since.
  Marks found(context.map.points());
  std::vector<float> last_angles_rad;
  std::vector<int> matched;
  for (size_t i = 0; i < last_points.size(); ++i) {
    if (!last_points[i].IsValid()) continue;
    const PointId id = context.map.Resolve(last_points[i]);
    const MapPoint* point = context.map.Find(id);
    if (!point || found.Contains(id)) continue;
    const Eigen::Vector3d x = cam_from_world * point->position;
    if (x.z() < kMinDepth) continue;
    const Eigen::Vector2d px = context.camera.Project(x);
    if (!context.bounds.Contains(px)) continue;
    const Keypoint& last_keypoint = last.seen->features.keypoints[i];
    WindowQuery query;
    query.x_px = static_cast<float>(px.x());
    query.y_px = static_cast<float>(px.y());
    query.radius_px = static_cast<float>(window_px * context.scales.scale(last_keypoint.octave));
    query.octaves = {std::max(0, last_keypoint.octave - 1), last_keypoint.octave + 1};
    query.max_distance = options.max_distance;
    const auto match = BestMatchInWindow(point->descriptor, query, seen.features, seen.grid, taken);
    if (!match || !frame->placement.Match(match->index, *point)) continue;
    taken[match->index] = 1;
    found.Insert(id);
    last_angles_rad.push_back(last_keypoint.angle_rad);
    matched.push_back(match->index);
  }
  return DropRotationOutliers(last_angles_rad, matched, frame);
}

int MatchKeyframe(const TrackingContext& context, KeyframeId keyframe_id, const SE3& cam_from_world,
                  Frame* frame) {
  const Keyframe* keyframe = context.map.Find(keyframe_id);
  frame->PlaceIn(keyframe ? keyframe->map : MapId(), cam_from_world);
  if (!keyframe) return 0;
  std::vector<const MapPoint*> points;
  std::vector<Descriptor> descriptors;
  for (const PointId id : keyframe->points) {
    if (const MapPoint* point = context.map.Find(id)) {
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

PoseMeasurements Measure(const TrackingContext& context, Frame* frame, std::vector<int>* features,
                         std::vector<int>* segments) {
  PoseMeasurements measurements;
  Placement& placement = frame->placement;
  for (int i = 0; i < static_cast<int>(placement.points().size()); ++i) {
    const MapPoint* point = context.map.Find(placement.points()[i]);
    if (!point) {
      placement.UnmatchPoint(i);
      continue;
    }
    const Keypoint& keypoint = frame->seen->features.keypoints[i];
    measurements.points.push_back(
        {point->position, keypoint.Position(), CornerSqrtInformation(keypoint, context.scales)});
    features->push_back(i);
  }
  for (int i = 0; i < static_cast<int>(placement.lines().size()); ++i) {
    const MapLine* line = context.map.Find(placement.lines()[i]);
    if (!line) {
      placement.UnmatchLine(i);
      continue;
    }
    const LineSegment& segment = frame->seen->segments()[i];
    const double sigma_px = LineSigma_px(segment.sigma_px);
    measurements.lines.push_back({line->start, line->end, segment.start_px.cast<double>(),
                                  segment.end_px.cast<double>(), 1 / (sigma_px * sigma_px)});
    segments->push_back(i);
  }
  return measurements;
}

int OptimizeFrame(const TrackingContext& context, const PoseOptimizerOptions& options, Frame* frame,
                  const std::optional<RotationMeasurement>& rotation) {
  std::vector<int> features, segments;
  PoseMeasurements measurements = Measure(context, frame, &features, &segments);
  measurements.rotation = rotation;
  Placement& placement = frame->placement;
  const PoseEstimate estimate =
      OptimizePose(context.camera, measurements, placement.cam_from_world, options);
  placement.cam_from_world = estimate.cam_from_world;
  placement.covariance = estimate.covariance;
  placement.num_matches = static_cast<int>(measurements.points.size());
  placement.inliers = estimate.num_inliers;
  for (size_t i = 0; i < features.size(); ++i) {
    if (!estimate.inliers[i]) placement.UnmatchPoint(features[i]);
  }
  placement.line_inliers = estimate.num_line_inliers;
  for (size_t i = 0; i < segments.size(); ++i) {
    if (!estimate.line_inliers[i]) placement.UnmatchLine(segments[i]);
  }
  return placement.inliers;
}

}  // namespace vpslam
