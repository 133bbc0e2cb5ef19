// When a picture was taken, for cameras that say so on a clock of their own, and for streams that
// hand out what they had kept first.
#pragma once

#include <cstdint>
#include <optional>

namespace vpslam {

/// Microseconds since 1970 that never jump: the wall clock is read once.
class SteadyWallClock {
 public:
  SteadyWallClock();
  int64_t Now_us() const { return FromMonotonic_us(MonotonicNow_us()); }
  /// A time of CLOCK_MONOTONIC on this clock.
  int64_t FromMonotonic_us(int64_t monotonic_us) const { return monotonic_us + offset_us_; }
  static int64_t MonotonicNow_us();

 private:
  int64_t offset_us_;
};

/// When a driver says that it took a picture that was read at `read_us`, on `clock`. Drivers count
/// by the monotonic clock, old ones by the wall clock; what is neither, or lies more than 2 s back,
/// is no such time, and the picture is as old as its reading.
int64_t CaptureTime_us(int64_t driver_us, int64_t read_us, const SteadyWallClock& clock);

/// Puts the times of a stream, which begin anywhere, on the wall clock.
///
/// A server begins with what it had kept: a burst whose pictures come faster than they were taken.
/// The picture that waited least on its way tells the two clocks' difference, and none does before
/// the burst is over.
class StreamClock {
 public:
  /// The burst cannot last longer: there may be servers that always send faster.
  static constexpr int64_t kMaxBurst_us = 5'000'000;
  /// Beyond this the stream's clock has jumped, and a new difference is taken.
  static constexpr int64_t kMaxDelay_us = 2'000'000;

  /// The stamp of a picture of time `stream_us` that came at `arrival_us`; nullopt while the burst
  /// lasts. Increasing, if the stream's times are. A stream without times (0 again and again) gets
  /// those of arrival.
  std::optional<int64_t> Stamp_us(int64_t stream_us, int64_t arrival_us);

 private:
  struct Picture {
    int64_t stream_us, arrival_us;
  };
  std::optional<Picture> first_, last_;
  int64_t offset_us_ = 0;  ///< arrival - stream, of the picture that waited least
  int64_t last_stamp_us_ = 0;
  bool burst_is_over_ = false;
};

}  // namespace vpslam
