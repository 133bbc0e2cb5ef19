// The pose of a frame in the map, in two steps: from the last frame, and from the local map around
// it, with what vanishing points say. [Mur15] sec. V; the paper's fig. 2.
#pragma once

#include <map>
#include <optional>
#include <random>
#include <vector>

#include "core/messages/keyframe_proposal.h"
#include "frontend/frame.h"
#include "frontend/frame_tracking.h"
#include "frontend/local_map.h"
#include "frontend/rotation_refinement.h"
#include "frontend/tracker_options.h"

namespace vpslam {

class PoseTracker {
 public:
  /// Both must outlive it.
  PoseTracker(const TrackingContext& context, const TrackerOptions& options)
      : context_(context), options_(options), paper_rotation_(context.camera, options.rotation) {}

  /// A first pose: from the points and lines that `last` saw, predicted with `velocity` (this
  /// frame's camera from the last one's), or else from the points of the keyframe that `last` hangs
  /// on. False if too few of them are found both times.
  bool TrackFrom(const Frame& last, const std::optional<SE3>& velocity, Frame* frame) const;

  /// The pose from all points and lines of the map around the first pose, and with the modes of
  /// rotation and translation. `local` receives what is around. False if too little of it is found.
  bool TrackLocalMap(std::mt19937_64& rng, Frame* frame, LocalMap* local);

  /// How often each point was predicted visible, and was really found, since the last call.
  std::vector<PointSighting> TakeSightings();

  /// Drops the directions that the paper's mode has frozen. To be called when the frames to come
  /// are in other coordinates, or in another place.
  void ForgetDirections() { paper_rotation_.Reset(); }

 private:
  struct SightingCounts {
    int visible = 0, found = 0;
  };

  bool TrackWithMotion(const Frame& last, const std::optional<SE3>& velocity, Frame* frame) const;
  bool TrackWithKeyframe(const Frame& last, Frame* frame) const;
  std::optional<RotationMeasurement> MeasuredRotation(const Frame& frame) const;
  /// The paper's modes: overwrites rotation and translation after the pose was optimised.
  void Overwrite(std::mt19937_64& rng, Frame* frame);

  const TrackingContext& context_;
  const TrackerOptions& options_;
  PaperRotation paper_rotation_;
  /// The keyframe that shared most with the last frame. It stands in for the frame's own keyframe
  /// while that is still on its way into the map.
  KeyframeId reference_in_map_;
  std::map<PointId, SightingCounts> sightings_;
};

}  // namespace vpslam
