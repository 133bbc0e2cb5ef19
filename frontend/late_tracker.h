// Places frames in the map that came before it: those before and between the two views from which
// the map was started.
//
// Walks from a keyframe frame by frame, backwards in time before it and forwards after it, with the
// constant-velocity model and the local map, as live tracking does.
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
  bool Busy() const { return !walks_.empty(); }
  void Clear() { walks_.clear(); }

  /// Works on one frame; returns it if it could be placed.
  std::optional<Frame> Step(const TrackingContext& context);

 private:
  /// Frames still to be placed, next first, and the last that was.
  struct Walk {
    std::deque<Frame> todo;
    Frame last;
    bool has_velocity = false;
    SE3 velocity;
    int failures = 0;
  };

  bool Place(const TrackingContext& context, const Walk& walk, Frame* frame) const;

  TrackerOptions options_;
  std::vector<Walk> walks_;
};

}  // namespace vpslam
