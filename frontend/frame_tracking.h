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

/// Matches the points that `last` saw, projected with frame->cam_from_world. Returns how many.
int MatchLastFrame(const TrackingContext& context, const Frame& last, double window_px,
                   const MotionTrackingOptions& options, Frame* frame);

/// Matches the keyframe's points by descriptor alone. Returns how many.
int MatchKeyframe(const TrackingContext& context, KeyframeId keyframe, Frame* frame);

/// What the frame's matches say about its pose: `features` and `segments` receive the index of
/// each. Matches with what is gone are taken away.
PoseMeasurements Measure(const TrackingContext& context, Frame* frame, std::vector<int>* features,
                         std::vector<int>* segments);

/// Optimises the pose from the frame's matches and, if there is one, a measured rotation; those
/// that do not fit are taken away. Returns the number that fit.
int OptimizeFrame(const TrackingContext& context, const PoseOptimizerOptions& options, Frame* frame,
                  const std::optional<RotationMeasurement>& rotation = {});

/// Lets the frame's pose hang on `reference`. False if the map does not have that keyframe.
bool HangOn(const Map& map, KeyframeId reference, Frame* frame);

/// The map has changed: the frame moves with the keyframe that it hangs on and, if it has become a
/// keyframe itself, has that one's points. `velocity` (of cameras, may be nullptr) keeps up with
/// the map's unit of length. False if the keyframe is not there (any more).
bool FollowMap(const Map& map, Frame* frame, SE3* velocity);

}  // namespace vpslam
