#include "player/play_control.h"

#include <gtest/gtest.h>

namespace vpslam {
namespace {

using Clock = PlayControl::Clock;
using std::chrono::milliseconds;

class PlayControlTest : public ::testing::Test {
 protected:
  /// Milliseconds until a frame with this stamp may go out; -1 while paused.
  double Wait_ms(int64_t stamp_us) {
    const auto due = control_.Due(stamp_us, now_);
    return due ? std::chrono::duration<double, std::milli>(*due - now_).count() : -1;
  }
  void Obey(CommandAction action, double value = 0) {
    EXPECT_TRUE(control_.Obey({"player", action, value}));
  }

  PlayControl control_;
  Clock::time_point now_ = Clock::now();
};

TEST_F(PlayControlTest, LetsAllThroughUnlessAsked) {
  for (int64_t stamp_us : {0, 1'000'000, 50'000'000}) EXPECT_EQ(Wait_ms(stamp_us), 0);
  EXPECT_FALSE(control_.Obey({"player", CommandAction::kSendCamera}));
  EXPECT_EQ(control_.changes(), 0);
}

TEST_F(PlayControlTest, PausesAndGoesOn) {
  Obey(CommandAction::kPause);
  EXPECT_TRUE(control_.paused());
  EXPECT_EQ(Wait_ms(0), -1);
  Obey(CommandAction::kResume);
  EXPECT_FALSE(control_.paused());
  EXPECT_EQ(Wait_ms(0), 0);
}

TEST_F(PlayControlTest, StepsThenPauses) {
  Obey(CommandAction::kPause);
  Obey(CommandAction::kStep, 2);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(Wait_ms(i), 0);
    control_.Sent();
  }
  EXPECT_EQ(Wait_ms(2), -1);
  Obey(CommandAction::kStep);  // one, without a number
  EXPECT_EQ(Wait_ms(2), 0);
  control_.Sent();
  EXPECT_EQ(Wait_ms(3), -1);
}

TEST_F(PlayControlTest, ARateSpacesFrames) {
  Obey(CommandAction::kSetRate, 0.5);
  EXPECT_EQ(Wait_ms(1'000'000), 0);
  EXPECT_NEAR(Wait_ms(1'033'000), 66, 1e-3);
  now_ += milliseconds(60);
  EXPECT_NEAR(Wait_ms(1'033'000), 6, 1e-3);
  Obey(CommandAction::kSetRate, 0);
  EXPECT_EQ(Wait_ms(1'066'000), 0);
}

TEST_F(PlayControlTest, APauseIsNotCaughtUpWith) {
  Obey(CommandAction::kSetRate, 1);
  EXPECT_EQ(Wait_ms(0), 0);
  Obey(CommandAction::kPause);
  now_ += milliseconds(5000);
  Obey(CommandAction::kResume);
  EXPECT_EQ(Wait_ms(33'000), 0);
  EXPECT_NEAR(Wait_ms(66'000), 33, 1e-3);
}

}  // namespace
}  // namespace vpslam
