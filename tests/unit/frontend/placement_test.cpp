#include "frontend/placement.h"

#include <gtest/gtest.h>

#include "tests/unit/frontend/tracking_scene.h"
#include "tests/unit/synthetic_lines.h"

namespace vpslam {
namespace {

TEST(Placement, CopiesOfAFrameShareWhatWasSeen) {
  TrackingScene s(1, {});
  const Frame frame = s.TrackedFrame(PoseAt({0.3, 0, 0}), 7);
  Frame copy = frame;
  EXPECT_EQ(copy.seen, frame.seen);
  // What is believed of the copy is its own.
  copy.PlaceIn(MapId(1), SE3());
  EXPECT_EQ(copy.placement.map(), MapId(1));
  EXPECT_EQ(TrackingScene::NumMatched(copy), 0);
  EXPECT_EQ(frame.placement.map(), MapId(0));
  EXPECT_GT(TrackingScene::NumMatched(frame), 100);
}

TEST(Placement, InNoMapThereIsNothingToMatch) {
  TrackingScene s(1, {});
  Frame frame = s.NewFrame(PoseAt({0.3, 0, 0}), 7);
  EXPECT_FALSE(frame.placement.map().IsValid());
  EXPECT_TRUE(frame.placement.points().empty());
  EXPECT_FALSE(frame.placement.Match(0, s.Point(PointId(0))));
}

TEST(Placement, LandmarksOfAnotherMapAreRefused) {
  SyntheticLineMap m(1, {}, PosesSideBySide(3));
  const LineId line = m.AddLine(m.SeenBy(2).front(), m.AllKeyframes());
  ASSERT_TRUE(m.map.map.Find(line));
  const SyntheticView view = m.scene.Look(PoseAt({0.3, 0, 0}));
  const auto lines = std::make_shared<const LineSet>(m.lines.Look(m.scene.camera, SE3()).set);
  const auto seen = FrameObservation::Make(0, 0, view.features, m.scene.bounds, lines);
  ASSERT_GT(seen->num_segments(), 0);
  const MapPoint& point = *m.map.map.Find(PointId(0));

  Placement here(MapId(0), *seen, SE3());
  EXPECT_TRUE(here.Match(3, point));
  EXPECT_TRUE(here.Match(0, *m.map.map.Find(line)));
  EXPECT_EQ(here.points()[3], point.id);
  EXPECT_EQ(here.lines()[0], line);

  Placement elsewhere(MapId(1), *seen, SE3());
  EXPECT_FALSE(elsewhere.Match(3, point));
  EXPECT_FALSE(elsewhere.Match(0, *m.map.map.Find(line)));
  EXPECT_FALSE(elsewhere.points()[3].IsValid());
  EXPECT_FALSE(elsewhere.lines()[0].IsValid());
}

TEST(Placement, FollowsItsMapIntoAnother) {
  TrackingScene s(2, {});
  Frame frame = s.TrackedFrame(PoseAt({0.3, 0.1, 0}), 7, KeyframeId(1));
  const Sim3 new_from_old{ExpSo3({0.5, 1, -0.5}), {1, 2, 3}, 4};
  s.map.map.Transform(MapId(0), new_from_old);
  s.map.map.Absorb(MapId(0), MapId(5));
  SE3 velocity(ExpSo3({0, 0.1, 0}), {0.1, 0, 0});
  ASSERT_TRUE(frame.placement.Follow(s.map.map, *frame.seen, &velocity));
  EXPECT_EQ(frame.placement.map(), MapId(5));
  EXPECT_LT(
      (frame.placement.cam_from_world.Center() - new_from_old * s.TruthOf(frame).Center()).norm(),
      1e-9);
  EXPECT_NEAR(velocity.translation.x(), 0.4, 1e-12);
  EXPECT_TRUE(frame.placement.Match(0, s.Point(PointId(0)))) << "the points came along";
}

TEST(Placement, TheMapIsKnownAlsoWhereTheKeyframeIsStillToCome) {
  TrackingScene s(3, {});
  Frame frame = s.TrackedFrame(PoseAt({0.3, 0, 0}), 7);
  const SE3 pose = frame.placement.cam_from_world;
  frame.placement.BecomeKeyframe(KeyframeId(99));
  s.map.map.Absorb(MapId(0), MapId(5));
  EXPECT_FALSE(frame.placement.Follow(s.map.map, *frame.seen, nullptr));
  EXPECT_EQ(frame.placement.map(), MapId(5));
  EXPECT_EQ(frame.placement.cam_from_world.translation, pose.translation);
}

TEST(Placement, AFrameThatBecameAKeyframeHasThatOnesMatches) {
  TrackingScene s(4, {});
  Frame frame = s.NewFrame(PoseAt({0.3, 0, 0}), 7);
  frame.PlaceIn(MapId(0), PoseAt({0.3, 0, 0}));
  Keyframe keyframe;
  keyframe.id = KeyframeId(KeyframeEnd(s.map.map));
  keyframe.map = MapId(0);
  keyframe.frame_seq = 7;
  keyframe.cam_from_world = PoseAt({0.31, 0, 0});
  keyframe.parent = KeyframeId(1);
  keyframe.points.resize(frame.seen->num_features());
  s.map.map.Insert(keyframe);
  s.map.map.Observe(keyframe.id, 2, PointId(0));
  frame.placement.BecomeKeyframe(keyframe.id);
  ASSERT_TRUE(frame.placement.Follow(s.map.map, *frame.seen, nullptr));
  EXPECT_EQ(frame.placement.points()[2], PointId(0));
  EXPECT_EQ(static_cast<int>(frame.placement.points().size()), frame.seen->num_features());
  EXPECT_NEAR(frame.placement.cam_from_world.Center().x(), 0.31, 1e-12);
}

}  // namespace
}  // namespace vpslam
