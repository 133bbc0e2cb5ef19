#include "player/play_control.h"

namespace vpslam {

bool PlayControl::Obey(const Command& command) {
  switch (command.action) {
    case CommandAction::kPause:
      paused_ = true;
      steps_ = 0;
      break;
    case CommandAction::kResume:
      paused_ = false;
      break;
    case CommandAction::kStep:
      paused_ = true;
      steps_ += command.value >= 1 ? static_cast<int64_t>(command.value) : 1;
      break;
    case CommandAction::kSetRate:
      rate_ = command.value;
      break;
    default:
      return false;
  }
  anchor_.reset();  // no frame is owed from before
  ++changes_;
  return true;
}

std::optional<PlayControl::Clock::time_point> PlayControl::Due(int64_t stamp_us,
                                                               Clock::time_point now) {
  if (paused()) return std::nullopt;
  if (rate_ == 0 || paused_) return now;
  if (!anchor_) anchor_ = Anchor{stamp_us, now};
  const std::chrono::duration<double, std::micro> since_anchor(
      static_cast<double>(stamp_us - anchor_->stamp_us) / rate_);
  return anchor_->time + std::chrono::duration_cast<Clock::duration>(since_anchor);
}

void PlayControl::Sent() {
  if (steps_ > 0) --steps_;
}

}  // namespace vpslam
