#include "recorder/trajectory.h"

#include <clocale>
#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/recorder/synthetic_run.h"

namespace vpslam {
namespace {

TEST(FormatTum, WritesTheSameBytesEverywhere) {
  const char* old_locale = std::setlocale(LC_ALL, "de_DE.UTF-8");  // where installed
  EXPECT_EQ(
      FormatTum({{1305031229528748, SE3(Eigen::Quaterniond(-1, 0, 0, 0), {0.5, -0.25, 1e-3})}}),
      "1305031229.528748 0.500000000 -0.250000000 0.001000000 "
      "0.000000000 0.000000000 0.000000000 1.000000000\n");
  if (old_locale) std::setlocale(LC_ALL, "C");
}

TEST(FormatTum, KnowsNoNegativeZero) {
  EXPECT_EQ(FormatTum({{0, SE3(Eigen::Quaterniond(1, -0.0, -1e-12, 0), {-0.0, -4e-10, -6e-10})}}),
            "0.000000 0.000000000 0.000000000 -0.000000001 "
            "0.000000000 0.000000000 0.000000000 1.000000000\n");
}

TEST(FormatStamp, IsExact) {
  EXPECT_EQ(FormatStamp(0), "0.000000");
  EXPECT_EQ(FormatStamp(7), "0.000007");
  EXPECT_EQ(FormatStamp(-1'500'000), "-1.500000");
  EXPECT_EQ(FormatStamp(std::numeric_limits<int64_t>::max()), "9223372036854.775807");
  EXPECT_EQ(FormatStamp(std::numeric_limits<int64_t>::min()), "-9223372036854.775808");
}

/// Keyframe 0 at the origin; keyframe 1 at x = 2, turned, moved to x = 3 in the end; keyframe 2, a
/// child of 1, culled while it stood 1 in front of it (along 1's z axis).
class TwoMaps : public ::testing::Test {
 protected:
  void SetUp() override {
    MapDelta first = MakeDelta(0);
    first.keyframes = {MakeKeyframe(0, 0, 0, CamAt(0)),
                       MakeKeyframe(1, 0, 2, QuarterTurn() * CamAt(2)),
                       MakeKeyframe(2, 0, 4, CamAt(0, 0, 1) * QuarterTurn() * CamAt(2))};
    first.keyframes[1].parent = KeyframeId(0);
    first.keyframes[2].parent = KeyframeId(1);
    ASSERT_TRUE(run_.Apply(first));
    MapDelta second = MakeDelta(1);
    KeyframeState moved = first.keyframes[1];
    moved.cam_from_world = QuarterTurn() * CamAt(3);
    KeyframeState culled = first.keyframes[2];
    culled.culled = true;
    culled.cam_from_parent = CamAt(0, 0, 1);
    second.keyframes = {moved, culled, MakeKeyframe(3, 1, 8, CamAt(10))};
    ASSERT_TRUE(run_.Apply(second));
  }
  static Eigen::Vector3d Center(const StampedPose& pose) { return pose.world_from_cam.translation; }

  RunRecord run_;
};

TEST_F(TwoMaps, PosesFollowTheirReferenceKeyframes) {
  run_.Add(MakePose(0, 0, 0, SE3(), CamAt(0)));
  run_.Add(MakePose(3, 0, 1, CamAt(0, 0, 0.5), SE3()));
  run_.Add(MakePose(5, 0, 2, CamAt(0, 0, 0.25), SE3()));
  run_.Add(MakePose(9, 1, 3, CamAt(1), SE3()));
  const auto trajectories = FinalTrajectories(run_);
  ASSERT_EQ(trajectories.size(), 2u);
  EXPECT_EQ(trajectories[0].map, MapId(0));
  ASSERT_EQ(trajectories[0].poses.size(), 3u);
  EXPECT_NEAR(Center(trajectories[0].poses[0]).norm(), 0, 1e-12);
  // The camera's z axis is the world's -x axis: forward by 0.5 from x = 3, and by 1 + 0.25.
  EXPECT_NEAR((Center(trajectories[0].poses[1]) - Eigen::Vector3d(2.5, 0, 0)).norm(), 0, 1e-12);
  EXPECT_NEAR((Center(trajectories[0].poses[2]) - Eigen::Vector3d(1.75, 0, 0)).norm(), 0, 1e-12);
  EXPECT_EQ(trajectories[0].poses[2].stamp_us, 500'000);
  EXPECT_NEAR(std::abs(trajectories[0].poses[2].world_from_cam.rotation.y()), std::sqrt(0.5),
              1e-12);
  EXPECT_EQ(trajectories[1].map, MapId(1));
  EXPECT_NEAR((Center(trajectories[1].poses.at(0)) - Eigen::Vector3d(11, 0, 0)).norm(), 0, 1e-12);
}

TEST_F(TwoMaps, TheMapWithMostFramesComesFirst) {
  run_.Add(MakePose(0, 0, 0, SE3(), CamAt(0)));
  EXPECT_EQ(MainMap(run_), MapId(0));
  run_.Add(MakePose(9, 1, 3, SE3(), CamAt(0)));
  EXPECT_EQ(MainMap(run_), MapId(0)) << "ties go to the older map";
  run_.Add(MakePose(10, 1, 3, SE3(), CamAt(0)));
  EXPECT_EQ(MainMap(run_), MapId(1));
  EXPECT_EQ(FinalTrajectories(run_)[0].poses.size(), 2u);
}

TEST_F(TwoMaps, WithoutFramesTheMapWithMostKeyframesIsTheMainOne) {
  EXPECT_EQ(MainMap(run_), MapId(0));
  EXPECT_FALSE(MainMap(RunRecord()).IsValid());
}

TEST_F(TwoMaps, OnlyMeasuredPosesCount) {
  FramePose lost = MakePose(0, 0, 0, SE3(), CamAt(0));
  lost.state = TrackingState::kLost;
  FramePose unmeasured = MakePose(1, 0, 0, SE3(), CamAt(0));
  unmeasured.inliers = 0;
  const FramePose unknown_reference = MakePose(2, 0, 77, SE3(), CamAt(0));
  const FramePose no_reference = MakePose(3, 0, -1, SE3(), CamAt(0));
  for (const FramePose& pose : {lost, unmeasured, unknown_reference, no_reference}) run_.Add(pose);
  EXPECT_TRUE(FinalTrajectories(run_).empty());
}

TEST_F(TwoMaps, TheLastPoseOfAFrameWins) {
  FramePose untracked = MakePose(0, 0, 0, SE3(), CamAt(0));
  untracked.state = TrackingState::kInitialising;
  run_.Add(untracked);
  FramePose late = MakePose(0, 0, 0, CamAt(0, 4, 0), CamAt(0, 4, 0));
  late.live = false;
  run_.Add(late);
  run_.Add(MakePose(1, 0, 0, CamAt(1), CamAt(1)));
  FramePose corrected = MakePose(1, 0, 0, CamAt(2), CamAt(2));
  corrected.live = false;
  run_.Add(corrected);
  FramePose withdrawn = MakePose(2, 0, 0, CamAt(3), CamAt(3));
  run_.Add(withdrawn);
  withdrawn.state = TrackingState::kLost;
  withdrawn.live = false;
  run_.Add(withdrawn);

  const auto poses = FinalTrajectories(run_).at(0).poses;
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(Center(poses[0]).y(), 4);
  EXPECT_EQ(Center(poses[1]).x(), 2);
  const auto live = LiveTrajectory(run_);
  ASSERT_EQ(live.size(), 2u);
  EXPECT_EQ(live[0].stamp_us, 100'000);
  EXPECT_EQ(Center(live[0]).x(), 1);
  EXPECT_EQ(Center(live[1]).x(), 3);
}

TEST_F(TwoMaps, FramesOfAnErasedMapAreGone) {
  run_.Add(MakePose(0, 0, 0, SE3(), CamAt(0)));
  run_.Add(MakePose(9, 1, 3, SE3(), CamAt(0)));
  MapDelta erase = MakeDelta(2);
  erase.erased_maps = {MapId(0)};
  ASSERT_TRUE(run_.Apply(erase));
  const auto trajectories = FinalTrajectories(run_);
  ASSERT_EQ(trajectories.size(), 1u);
  EXPECT_EQ(trajectories[0].map, MapId(1));
  EXPECT_EQ(LiveTrajectory(run_).size(), 2u);
}

TEST_F(TwoMaps, KeptKeyframesOfOneMap) {
  const auto poses = KeyframeTrajectory(run_.map(), MapId(0));
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[1].stamp_us, 200'000);
  EXPECT_NEAR((Center(poses[1]) - Eigen::Vector3d(3, 0, 0)).norm(), 0, 1e-12);
}

TEST_F(TwoMaps, KeyframesAreInOrderOfTimeAndEachTimeIsThereOnce) {
  MapDelta tie = MakeDelta(2);
  tie.keyframes = {MakeKeyframe(4, 0, 1, CamAt(1)), MakeKeyframe(5, 0, 2, CamAt(1))};
  ASSERT_TRUE(run_.Apply(tie));
  const auto poses = KeyframeTrajectory(run_.map(), MapId(0));
  ASSERT_EQ(poses.size(), 3u);
  EXPECT_EQ(poses[1].stamp_us, 100'000);
  EXPECT_EQ(poses[2].stamp_us, 200'000);
}

}  // namespace
}  // namespace vpslam
