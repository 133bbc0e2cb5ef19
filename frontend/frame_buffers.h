// Frames that are kept because they may be of use later.
#pragma once

#include <cstddef>
#include <deque>

#include "frontend/frame.h"

namespace vpslam {

/// The pre-loss buffer: the last frames that were tracked, oldest first. When the camera is lost
/// and a new map is begun, these frames stand in the map from before the loss.
class RecentFrames {
 public:
  /// A few seconds. A camera is mostly lost in a turn, where the map has few points; the buffer has
  /// to reach back to before the turn, where it has many.
  static constexpr size_t kMaxFrames = 100;

  void Add(Frame frame);
  const std::deque<Frame>& frames() const { return frames_; }

 private:
  std::deque<Frame> frames_;
};

/// Frames without a place in a map, and the tracked ones right before them. They can be placed when
/// a map has been started or the camera was found again.
struct PendingFrames {
  std::deque<Frame> frames;       ///< without a place, oldest first
  std::deque<Frame> before_loss;  ///< that were tracked; none if the camera never was

  /// Keeps the last `max_frames`. Once one is dropped, those from before the loss are cut off from
  /// the rest, and are dropped as well.
  void Add(const Frame& frame, size_t max_frames);
};

}  // namespace vpslam
