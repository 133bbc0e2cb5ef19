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

  /// Places frames around the start of a map: those between its first two keyframes, then those
  /// before, backwards. `frames`: in order of time. `first`: the frame that became the map's first
  /// keyframe, with `reference` set to it. `second_seq`: the number of the second's frame.
  void Start(std::vector<Frame> frames, const Frame& first, int64_t second_seq);
  /// Places the frames of a loss backwards from `found`, the frame with which it ended. `frames`:
  /// in order of time.
  void Return(std::vector<Frame> frames, const Frame& found);
  bool Busy() const { return !walks_.empty(); }

  /// Works on one frame; returns it if it could be placed.
  std::optional<Frame> Step(const TrackingContext& context);

  /// The frame that was placed last became a keyframe. Once that is in the map, the walk goes on
  /// with all the points that it has then.
  void GoOnFrom(const Frame& keyframe);
  /// The rest of the walk at hand is not to be placed.
  void EndWalk() { walks_.front().todo.clear(); }
  /// Frames that were placed since the last keyframe of the walk, or since the walk began.
  int frames_since_keyframe() const { return walks_.front().frames_since_keyframe; }
  /// Whether the last keyframe of the walk is still on its way into the map.
  bool Waits(const Map& map) const {
    return Busy() && walks_.front().last.placement.reference > map.latest_keyframe();
  }

 private:
  /// Frames still to be placed, the next one first, and the one that was placed last.
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
