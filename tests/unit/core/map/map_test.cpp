#include "core/map/map.h"

#include <gtest/gtest.h>

#include "random_map.h"

namespace vpslam {
namespace {

TEST(Map, BothSidesOfObservationsAgree) {
  RandomMap random(1);
  for (int step = 0; step < 60; ++step) {
    random.Step();
    const Map& map = random.map;
    for (int32_t k = 0; k < map.keyframe_end(); ++k) {
      const Keyframe* keyframe = map.Find(KeyframeId(k));
      if (!keyframe) continue;
      for (size_t i = 0; i < keyframe->points.size(); ++i) {
        if (!keyframe->points[i].IsValid()) continue;
        const MapPoint* point = map.Find(keyframe->points[i]);
        ASSERT_NE(point, nullptr);
        int found = 0;
        for (const Observation& o : point->observations) {
          found += o.keyframe == keyframe->id && o.feature == static_cast<int32_t>(i);
        }
        ASSERT_EQ(found, 1);
      }
    }
    for (int32_t p = 0; p < map.point_end(); ++p) {
      const MapPoint* point = map.Find(PointId(p));
      if (!point) continue;
      for (const Observation& o : point->observations) {
        const Keyframe* keyframe = map.Find(o.keyframe);
        ASSERT_NE(keyframe, nullptr);
        ASSERT_EQ(keyframe->points[o.feature], point->id);
      }
    }
  }
}

TEST(Map, WithTheManhattanFrameGoTheAxesOfItsLines) {
  Map map;
  for (const int m : {0, 1}) {
    Keyframe keyframe;
    keyframe.id = KeyframeId(m);
    keyframe.map = MapId(m);
    map.Insert(keyframe);
    map.SetManhattan(MapId(m), Eigen::Quaterniond::Identity());
  }
  const LineId here = map.CreateLine(MapId(0), KeyframeId(0), {0, 0, 1}, {1, 0, 1});
  const LineId elsewhere = map.CreateLine(MapId(1), KeyframeId(1), {0, 0, 1}, {1, 0, 1});
  map.SetAxis(here, 0);
  map.SetAxis(elsewhere, 0);
  Map replica;
  for (const MapDelta& delta : map.TakeDeltas({}, {})) ASSERT_TRUE(replica.Apply(delta));
  map.SetManhattan(MapId(0), std::nullopt);
  // The next frame of this map has its axes in another order.
  const Eigen::Quaterniond renamed(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()));
  map.SetManhattan(MapId(0), renamed);
  for (const MapDelta& delta : map.TakeDeltas({}, {})) ASSERT_TRUE(replica.Apply(delta));
  for (const Map* each : {&map, &replica}) {
    EXPECT_EQ(each->Find(here)->axis, -1);
    EXPECT_EQ(each->Find(elsewhere)->axis, 0);
  }
}

TEST(Map, FusedPointsForward) {
  Map map;
  Keyframe keyframe;
  keyframe.id = KeyframeId(0);
  keyframe.map = MapId(0);
  keyframe.points.resize(3);
  map.Insert(keyframe);
  const PointId a = map.CreatePoint(MapId(0), KeyframeId(0), {0, 0, 1});
  const PointId b = map.CreatePoint(MapId(0), KeyframeId(0), {0, 0, 2});
  const PointId c = map.CreatePoint(MapId(0), KeyframeId(0), {0, 0, 3});
  map.Observe(KeyframeId(0), 0, a);
  map.Fuse(a, b);
  map.Fuse(b, c);
  EXPECT_EQ(map.Resolve(a), c);
  EXPECT_EQ(map.Find(a), nullptr);
  EXPECT_EQ(map.Find(KeyframeId(0))->points[0], c);
  map.Erase(c);
  EXPECT_FALSE(map.Resolve(a).IsValid());
}

TEST(Map, CulledKeyframeMovesWithItsParent) {
  Map map;
  Keyframe first, second;
  first.id = KeyframeId(0);
  second.id = KeyframeId(1);
  first.map = second.map = MapId(0);
  second.parent = first.id;
  second.cam_from_world = SE3(ExpSo3({0, 0.1, 0}), Eigen::Vector3d(1, 0, 0));
  map.Insert(first);
  map.Insert(second);
  map.Cull(second.id);
  EXPECT_EQ(map.Find(second.id), nullptr);
  const SE3 moved(ExpSo3({0.2, 0, 0}), Eigen::Vector3d(0, 5, 0));
  map.SetPose(first.id, moved);
  SE3 pose;
  ASSERT_TRUE(map.CamFromWorld(second.id, &pose));
  const SE3 expected = second.cam_from_world * moved;
  EXPECT_NEAR(LocalCoordinates(expected, pose).norm(), 0, 1e-9);
  EXPECT_EQ(map.LivingAncestor(second.id), first.id);
}

}  // namespace
}  // namespace vpslam
