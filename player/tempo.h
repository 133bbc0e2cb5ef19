// When each image of a sequence is due, so that they follow each other as they were taken.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

namespace vpslam {

/// A player that is late catches up with what it missed, unless that is more than it may owe: then
/// the tempo starts anew from there.
class Tempo {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr std::chrono::milliseconds kMaxDebt{500};

  /// With `live`, everything is due at once: a camera sets the tempo itself.
  explicit Tempo(bool live = false) : live_(live) {}

  /// Of the image with this stamp, which is to be asked for once, in order.
  Clock::time_point Due(int64_t stamp_us, Clock::time_point now) {
    if (live_) return now;
    const std::chrono::microseconds stamp(stamp_us);
    if (!start_) start_ = now - stamp;
    if (now - (*start_ + stamp) > kMaxDebt) {
      start_ = now - stamp;
      ++restarts_;
    }
    return *start_ + stamp;
  }

  /// The next image is due when it is asked for, after a wait that was wanted.
  void StartAnew() { start_.reset(); }

  /// How often the player was later than it may be.
  int restarts() const { return restarts_; }

 private:
  const bool live_;
  std::optional<Clock::time_point> start_;  ///< of stamp 0
  int restarts_ = 0;
};

}  // namespace vpslam
