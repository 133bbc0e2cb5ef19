#include "recorder/run_record.h"

#include <gtest/gtest.h>

#include "tests/unit/recorder/synthetic_run.h"

namespace vpslam {
namespace {

TEST(RunRecord, ALaterPoseReplacesButTheLiveOneIsKept) {
  RunRecord run;
  FramePose live = MakePose(3, 0, 0, CamAt(1), CamAt(1));
  live.state = TrackingState::kInitialising;
  run.Add(live);
  FramePose late = MakePose(3, 0, 0, CamAt(2), CamAt(2));
  late.live = false;
  run.Add(late);
  ASSERT_EQ(run.frames().size(), 1u);
  EXPECT_EQ(run.frames().at(3).last.state, TrackingState::kTracking);
  EXPECT_EQ(run.frames().at(3).live->state, TrackingState::kInitialising);
  EXPECT_EQ(run.frames_in(), 4);
}

TEST(RunRecord, RefusesADeltaThatDoesNotFitAndTakesASnapshot) {
  RunRecord run;
  MapDelta first = MakeDelta(0);
  first.keyframes = {MakeKeyframe(0, 0, 5, CamAt(0))};
  EXPECT_TRUE(run.Apply(first));
  MapDelta third = MakeDelta(2);
  third.answers = KeyframeId(0);
  EXPECT_FALSE(run.Apply(third));
  EXPECT_TRUE(run.keyframes().empty());
  MapDelta snapshot = MakeDelta(0);
  snapshot.snapshot = true;
  snapshot.version = 3;
  snapshot.keyframes = {MakeKeyframe(1, 0, 9, CamAt(1))};
  EXPECT_TRUE(run.Apply(snapshot));
  EXPECT_FALSE(run.map().Find(KeyframeId(0)));
  EXPECT_TRUE(run.map().Find(KeyframeId(1)));
}

TEST(RunRecord, RemembersWhereAnsweredKeyframesCameFrom) {
  RunRecord run;
  MapDelta part = MakeDelta(0);
  part.keyframes = {MakeKeyframe(4, 0, 17, CamAt(0))};
  EXPECT_TRUE(run.Apply(part));
  MapDelta last = MakeDelta(1);
  last.answers = KeyframeId(4);
  last.times.local_ba_ms = 12;
  EXPECT_TRUE(run.Apply(last));
  MapDelta erase = MakeDelta(2);
  erase.erased_maps = {MapId(0)};
  EXPECT_TRUE(run.Apply(erase));
  ASSERT_EQ(run.keyframes().size(), 1u);
  EXPECT_EQ(run.keyframes().at(KeyframeId(4)).frame_seq, 17);
  EXPECT_EQ(run.keyframes().at(KeyframeId(4)).times.local_ba_ms, 12);
}

TEST(RunRecord, CountsTheImagesOfThePlayer) {
  RunRecord run;
  EXPECT_EQ(run.frames_in(), 0);
  run.Add(MakeStatus("player", 10, 40, 0, 0));
  run.Add(MakeStatus("player", 10, 60, 0, 0));
  run.Add(MakeStatus("frontend", 11, 99, 0, 0));
  EXPECT_EQ(run.frames_in(), 60);
}

TEST(RunRecord, MeasuresWallTimeFromFirstImageToLastPose) {
  RunRecord run;
  EXPECT_EQ(run.wall_s(), 0);
  for (int i = 0; i < 11; ++i) {
    FramePose pose = MakePose(i, 0, 0, CamAt(0), CamAt(0));
    pose.times.total_ms = i == 10 ? 250 : 10;
    run.Add(pose);
  }
  EXPECT_NEAR(run.wall_s(), 1.25, 1e-9);
}

}  // namespace
}  // namespace vpslam
