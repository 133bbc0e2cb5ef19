// The two clocks that messages carry, in microseconds.
#pragma once

#include <chrono>
#include <cstdint>

namespace vpslam {

/// CLOCK_MONOTONIC of this host: durations between processes, e.g. ImageFrame::published_us.
inline int64_t MonotonicMicroseconds() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// CLOCK_REALTIME: when a message was sent.
inline int64_t RealtimeMicroseconds() {
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace vpslam
