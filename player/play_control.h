// Pause, step and rate of a player, as people ask for them while it plays.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "core/messages/command.h"

namespace vpslam {

class PlayControl {
 public:
  using Clock = std::chrono::steady_clock;

  /// kPause, kResume, kStep, kSetRate; false for anything else.
  bool Obey(const Command& command);

  /// When a frame may go out, as far as pause and rate are concerned: nullopt while paused. To be
  /// asked for the next frame only, as often as one likes.
  std::optional<Clock::time_point> Due(int64_t stamp_us, Clock::time_point now);
  /// The frame that was asked for went out.
  void Sent();

  bool paused() const { return paused_ && steps_ == 0; }
  double rate() const { return rate_; }
  int64_t changes() const { return changes_; }  ///< how often Obey was true

 private:
  struct Anchor {
    int64_t stamp_us;
    Clock::time_point time;
  };

  bool paused_ = false;
  int64_t steps_ = 0;  ///< frames still to go out before the next pause
  double rate_ = 0;    ///< times real time, at most; 0: no limit
  int64_t changes_ = 0;
  std::optional<Anchor> anchor_;  ///< from where the rate counts
};

}  // namespace vpslam
