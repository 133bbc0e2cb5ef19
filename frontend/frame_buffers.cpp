#include "frontend/frame_buffers.h"

#include <utility>

namespace vpslam {

void RecentFrames::Add(Frame frame) {
  frames_.push_back(std::move(frame));
  if (frames_.size() > kMaxFrames) frames_.pop_front();
}

void PendingFrames::Add(const Frame& frame, size_t max_frames) {
  frames.push_back(frame);
  if (frames.size() <= max_frames) return;
  frames.pop_front();
  before_loss.clear();
}

}  // namespace vpslam
