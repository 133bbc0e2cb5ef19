// The work on frames that could not be placed when they came, spread over the images that follow.
#pragma once

#include <cstddef>
#include <cstdint>

#include "frontend/frame_buffers.h"
#include "frontend/frame_tracking.h"
#include "frontend/keyframe_proposer.h"
#include "frontend/late_tracker.h"
#include "frontend/pre_loss_placements.h"
#include "frontend/tracker_interface.h"
#include "frontend/tracker_options.h"

namespace vpslam {

class LateWork {
 public:
  /// All must outlive it.
  LateWork(const TrackingContext& context, const TrackerOptions& options,
           KeyframeProposer* proposer)
      : context_(context), options_(options), proposer_(*proposer), walks_(options) {}

  /// A map has passed its probation: frames from before and during its start are to be placed in
  /// it. `first`: the frame that became its first keyframe, and hangs on that. `second_seq`: the
  /// number of the frame that became its second one.
  void PlaceAroundStart(const PendingFrames& pending, const Frame& first, int64_t second_seq);
  /// The camera was found: the frames since it was lost are to be placed, backwards from there.
  void PlaceBackFrom(const Frame& found, const PendingFrames& pending);

  /// Works on a few frames. `num_proposed`: how many keyframes the present image brought.
  void Step(size_t num_proposed, TrackerOutput* output);
  /// Works on all frames that are left, and proposes none.
  void Finish(TrackerOutput* output);

 private:
  /// Whether a frame that was placed becomes a keyframe: where it stands the map shows little, or
  /// it ties two maps together.
  bool IsKeyframe(const Frame& frame, bool has_seam) const;

  const TrackingContext& context_;
  const TrackerOptions& options_;
  KeyframeProposer& proposer_;
  LateTracker walks_;
  PreLossPlacements pre_loss_;  ///< of frames that a walk may come to
};

}  // namespace vpslam
