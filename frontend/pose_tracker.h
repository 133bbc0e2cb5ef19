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

  /// From what `last` saw, where `velocity` (this frame's camera from the last one's) leads the
  /// frame, or else from the keyframe that `last` hangs on. False if neither shows enough.
  bool TrackFrom(const Frame& last, const std::optional<SE3>& velocity, Frame* frame) const;

  /// From the points and lines of its map around the frame's pose, and the modes of rotation and
  /// translation. `local` receives what is around. False if too little of it is found.
  bool TrackLocalMap(std::mt19937_64& rng, Frame* frame, LocalMap* local);

  /// How often each point of the local map was to be seen, and was found, since the last call.
  std::vector<PointSighting> TakeSightings();

  /// The frames to come are in another world, or elsewhere: the paper's directions are taken anew.
  void ForgetDirections() { paper_rotation_.Reset(); }

 private:
  struct SightingCounts {
    int visible = 0, found = 0;
  };

  bool TrackWithMotion(const Frame& last, const std::optional<SE3>& velocity, Frame* frame) const;
  bool TrackWithKeyframe(const Frame& last, Frame* frame) const;
  std::optional<RotationMeasurement> MeasuredRotation(const Frame& frame) const;
  /// What the paper does after the pose was optimised.
  void Overwrite(std::mt19937_64& rng, Frame* frame);

  const TrackingContext& context_;
  const TrackerOptions& options_;
  PaperRotation paper_rotation_;
  KeyframeId reference_in_map_;  ///< of the last frame, where that became a keyframe itself
  std::map<PointId, SightingCounts> sightings_;
};

}  // namespace vpslam
