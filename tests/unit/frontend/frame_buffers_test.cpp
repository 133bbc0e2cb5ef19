#include "frontend/frame_buffers.h"

#include <gtest/gtest.h>

namespace vpslam {
namespace {

Frame FrameNumber(int64_t seq) {
  Frame frame;
  frame.seen = FrameObservation::Make(seq, 0, Features(), Camera::Bounds());
  return frame;
}

TEST(RecentFrames, KeepsTheLast) {
  RecentFrames recent;
  EXPECT_TRUE(recent.frames().empty());
  constexpr int kMax = RecentFrames::kMaxFrames;
  for (int i = 0; i < kMax + 40; ++i) recent.Add(FrameNumber(i));
  ASSERT_EQ(recent.frames().size(), RecentFrames::kMaxFrames);
  EXPECT_EQ(recent.frames().front().seq(), 40);
  EXPECT_EQ(recent.frames().back().seq(), kMax + 39);
}

TEST(PendingFrames, WhatCameBeforeIsOfUseWhileNothingIsMissing) {
  PendingFrames pending;
  pending.before_loss = {FrameNumber(1), FrameNumber(2)};
  for (int i = 3; i < 8; ++i) pending.Add(FrameNumber(i), 5);
  EXPECT_EQ(pending.frames.size(), 5u);
  EXPECT_EQ(pending.before_loss.size(), 2u);
  pending.Add(FrameNumber(8), 5);
  ASSERT_EQ(pending.frames.size(), 5u);
  EXPECT_EQ(pending.frames.front().seq(), 4);
  EXPECT_EQ(pending.frames.back().seq(), 8);
  EXPECT_TRUE(pending.before_loss.empty());
}

}  // namespace
}  // namespace vpslam
