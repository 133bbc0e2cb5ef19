// Finding map points in a frame, and the pose that explains them.
#pragma once

#include <optional>
#include <vector>

#include "core/features/scale_levels.h"
#include "core/geometry/camera.h"
#include "core/map/map.h"
#include "frontend/frame.h"
#include "frontend/tracker_options.h"

namespace vpslam {

/// What does not change from frame to frame.
struct TrackingContext {
  const Camera& camera;
  const Camera::Bounds& bounds;
  const ScalePyramid& scales;
  const Map& map;
};

/// Places the frame at `cam_from_world` in the map in which `last` was tracked, and matches the
/// points that `last` saw. Returns how many.
int MatchLastFrame(const TrackingContext& context, const Frame& last, const SE3& cam_from_world,
                   double window_px, const MotionTrackingOptions& options, Frame* frame);

/// Places the frame at `cam_from_world` in the keyframe's map, and matches the keyframe's points by
/// descriptor alone. Returns how many; 0 if the map does not have that keyframe.
int MatchKeyframe(const TrackingContext& context, KeyframeId keyframe, const SE3& cam_from_world,
                  Frame* frame);

/// What the frame's matches say about its pose. `features` and `segments` receive the index of the
/// feature or segment behind each measurement. Matches with landmarks that were erased are removed.
PoseMeasurements Measure(const TrackingContext& context, Frame* frame, std::vector<int>* features,
                         std::vector<int>* segments);

/// Optimises the pose from the frame's matches and, if there is one, a measured rotation. Matches
/// that do not fit are removed. Returns the number of points that fit.
int OptimizeFrame(const TrackingContext& context, const PoseOptimizerOptions& options, Frame* frame,
                  const std::optional<RotationMeasurement>& rotation = {});

}  // namespace vpslam
