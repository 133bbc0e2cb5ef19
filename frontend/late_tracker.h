// Places frames in a map that could not be placed when they came: those before and between the two
// views from which the map was started, and those of a loss, back from where the camera was found.
//
// Walks from a keyframe, or from the frame that was found, frame by frame, backwards in time before
// it and forwards after it, with the constant-velocity model and the local map, as live tracking
// does.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "frontend/frame.h"
#include "frontend/frame_tracking.h"
#include "frontend/tracker_options.h"

namespace vpslam {

class LateTracker {
 public:
  explicit LateTracker(const TrackerOptions& options) : options_(options) {}

  /// `frames`: in order of time, from before the map stood. `first`: the frame that became the
  /// map's first keyframe, with `reference` set to it; `second_seq`: the frame of the second.
  void Start(std::vector<Frame> frames, const Frame& first, int64_t second_seq);
  /// `frames`: in order of time, of a loss; those before `found`, which was placed, are tried.
  void Return(std::vector<Frame> frames, const Frame& found);
  bool Busy() const { return !walks_.empty(); }

  /// Works on one frame; returns it if it could be placed.
  std::optional<Frame> Step(const TrackingContext& context);

  /// The frame that was placed last, as it was returned, became a keyframe: the walk goes on from
  /// it with all that it shows then.
  void GoOnFrom(const Frame& keyframe);
  /// What is left of the walk at hand is not worth it.
  void EndWalk() { walks_.front().todo.clear(); }
  /// Frames that were placed since that, or since the walk began.
  int frames_since_keyframe() const { return walks_.front().frames_since_keyframe; }
  /// Whether that keyframe is still on its way into the map.
  bool Waits(const Map& map) const {
    return Busy() && walks_.front().last.placement.reference > map.latest_keyframe();
  }

 private:
  /// Frames still to be placed, next first, and the last that was.
  struct Walk {
    std::deque<Frame> todo;
    Frame last;
    bool has_velocity = false;
    SE3 velocity;
    int failures = 0;
    int frames_since_keyframe = 0;
  };

  bool Place(const TrackingContext& context, const Walk& walk, Frame* frame) const;

  TrackerOptions options_;
  std::vector<Walk> walks_;
};

}  // namespace vpslam
