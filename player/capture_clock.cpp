#include "player/capture_clock.h"

#include <algorithm>
#include <chrono>

namespace vpslam {
namespace {

constexpr int64_t kMaxAge_us = 2'000'000;

}  // namespace

int64_t SteadyWallClock::MonotonicNow_us() {
  // On Linux this is CLOCK_MONOTONIC, by which V4L2 counts.
  return std::chrono::duration_cast<std::chrono::microseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

SteadyWallClock::SteadyWallClock()
    : offset_us_(std::chrono::duration_cast<std::chrono::microseconds>(
                     std::chrono::system_clock::now().time_since_epoch())
                     .count() -
                 MonotonicNow_us()) {}

int64_t CaptureTime_us(int64_t driver_us, int64_t read_us, const SteadyWallClock& clock) {
  for (const int64_t taken_us : {clock.FromMonotonic_us(driver_us), driver_us}) {
    if (taken_us <= read_us && taken_us > read_us - kMaxAge_us) return taken_us;
  }
  return read_us;
}

std::optional<int64_t> StreamClock::Stamp_us(int64_t stream_us, int64_t arrival_us) {
  if (last_ && stream_us == last_->stream_us) return last_stamp_us_ = arrival_us;
  const Picture picture{stream_us, arrival_us};
  if (!first_) {
    first_ = last_ = picture;
    offset_us_ = arrival_us - stream_us;
    return std::nullopt;
  }
  const int64_t interval_us = stream_us - last_->stream_us;
  const int64_t waited_us = arrival_us - last_->arrival_us;
  last_ = picture;
  const int64_t offset_us = arrival_us - stream_us;
  if (!burst_is_over_) {
    offset_us_ = std::min(offset_us_, offset_us);
    burst_is_over_ = waited_us > interval_us / 2 || arrival_us - first_->arrival_us > kMaxBurst_us;
    if (!burst_is_over_) return std::nullopt;
  } else if (offset_us > offset_us_ + kMaxDelay_us || offset_us < offset_us_ - kMaxDelay_us) {
    offset_us_ = offset_us;
  }
  const int64_t stamp_us = std::min(stream_us + offset_us_, arrival_us);
  return last_stamp_us_ = std::max(stamp_us, last_stamp_us_ + 1);
}

}  // namespace vpslam
