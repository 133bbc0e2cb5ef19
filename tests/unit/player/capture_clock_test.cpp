#include "player/capture_clock.h"

#include <vector>

#include <gtest/gtest.h>

namespace vpslam {
namespace {

constexpr int64_t kNow_us = 1'700'000'000'000'000;
constexpr int64_t kPeriod_us = 33'333;

TEST(CaptureTime, IsTheDriversWhereItIsATime) {
  const SteadyWallClock clock;
  const int64_t monotonic_us = SteadyWallClock::MonotonicNow_us();
  const int64_t read_us = clock.FromMonotonic_us(monotonic_us);
  EXPECT_EQ(CaptureTime_us(monotonic_us - 40'000, read_us, clock), read_us - 40'000);
  EXPECT_EQ(CaptureTime_us(read_us - 40'000, read_us, clock), read_us - 40'000) << "wall clock";
  EXPECT_EQ(CaptureTime_us(0, read_us, clock), read_us);
  EXPECT_EQ(CaptureTime_us(monotonic_us + 5'000, read_us, clock), read_us) << "in the future";
  EXPECT_EQ(CaptureTime_us(monotonic_us - 3'000'000, read_us, clock), read_us) << "far too old";
}

TEST(StreamClock, ABurstIsLeftOutAndGivesTheOffset) {
  StreamClock clock;
  // Two seconds were kept, and come within 0.1 s.
  for (int i = 0; i < 60; ++i) {
    EXPECT_EQ(clock.Stamp_us(i * kPeriod_us, kNow_us + i * 1'600), std::nullopt) << i;
  }
  // From here on each comes 50 ms after it was taken, and up to 20 ms later.
  const int64_t taken_0_us = kNow_us + 60 * 1'600 - 60 * kPeriod_us;
  int64_t last_us = 0;
  for (int i = 60; i < 200; ++i) {
    const int64_t taken_us = taken_0_us + i * kPeriod_us;
    const auto stamp = clock.Stamp_us(i * kPeriod_us, taken_us + 50'000 + i * 7919 % 20'000);
    ASSERT_TRUE(stamp) << i;
    EXPECT_NEAR(static_cast<double>(*stamp - taken_us), 0, 60'000);
    if (last_us > 0) {
      EXPECT_EQ(*stamp - last_us, kPeriod_us) << i;
    }
    last_us = *stamp;
  }
}

TEST(StreamClock, WithoutABurstAllButTheFirstAreTaken) {
  StreamClock clock;
  EXPECT_EQ(clock.Stamp_us(7'000'000, kNow_us), std::nullopt);
  EXPECT_EQ(clock.Stamp_us(7'000'000 + kPeriod_us, kNow_us + kPeriod_us), kNow_us + kPeriod_us);
}

TEST(StreamClock, AServerThatAlwaysHurriesIsFollowedInTheEnd) {
  StreamClock clock;
  int taken = 0;
  for (int i = 0; i < 1000; ++i) {
    taken += clock.Stamp_us(i * kPeriod_us, kNow_us + i * 10'000).has_value();
  }
  EXPECT_GT(taken, 400);
}

TEST(StreamClock, AJumpOfTheStreamsClockIsFollowed) {
  StreamClock clock;
  int64_t last_us = 0;
  for (int i = 0; i < 50; ++i) {
    const int64_t stream_us = i * kPeriod_us + (i < 25 ? 0 : 3'600'000'000);
    const auto stamp = clock.Stamp_us(stream_us, kNow_us + i * kPeriod_us);
    if (!stamp) continue;
    EXPECT_GT(*stamp, last_us);
    EXPECT_NEAR(static_cast<double>(*stamp - (kNow_us + i * kPeriod_us)), 0, 1'000) << i;
    last_us = *stamp;
  }
}

TEST(StreamClock, AStreamWithoutTimesIsStampedWhenItCame) {
  StreamClock clock;
  EXPECT_EQ(clock.Stamp_us(0, kNow_us), std::nullopt);
  EXPECT_EQ(clock.Stamp_us(0, kNow_us + 40'000), kNow_us + 40'000);
  EXPECT_EQ(clock.Stamp_us(0, kNow_us + 70'000), kNow_us + 70'000);
}

}  // namespace
}  // namespace vpslam
