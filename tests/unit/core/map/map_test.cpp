#include "core/map/map.h"

#include <initializer_list>

#include <gtest/gtest.h>

#include "core/map/invariants.h"
#include "core/map/map_replica.h"
#include "core/map/owned_map.h"
#include "random_map.h"

namespace vpslam {
namespace {

TEST(Map, TheInvariantsHoldWhateverHappens) {
  for (uint32_t seed = 1; seed <= 5; ++seed) {
    RandomMap random(seed);
    for (int step = 0; step < 60; ++step) {
      random.grows = MapId(step % 20 < 15 ? 0 : 1);
      random.Step();
      ASSERT_EQ(CheckInvariants(random.map), std::nullopt) << seed << " " << step;
    }
  }
}

TEST(Map, UnknownIdsAreErrors) {
  OwnedMap map;
  Keyframe keyframe;
  keyframe.id = KeyframeId(0);
  keyframe.map = MapId(0);
  map.Insert(keyframe);
  const PointId point = map.CreatePoint(MapId(0), keyframe.id, {0, 0, 1});
  for (const int64_t id : {-1, 1, 1 << 20}) {
    EXPECT_THROW(map.SetPose(KeyframeId(id), SE3()), UnknownIdError);
    EXPECT_THROW(map.SetParent(KeyframeId(id), keyframe.id), UnknownIdError);
    EXPECT_THROW(map.SetParent(keyframe.id, KeyframeId(id)), UnknownIdError);
    EXPECT_THROW(map.Cull(KeyframeId(id)), UnknownIdError);
    EXPECT_THROW(map.Observe(KeyframeId(id), 0, point), UnknownIdError);
    EXPECT_THROW(map.Observe(keyframe.id, 0, PointId(id)), UnknownIdError);
    EXPECT_THROW(map.Unobserve(keyframe.id, PointId(id)), UnknownIdError);
    EXPECT_THROW(map.SetPosition(PointId(id), {0, 0, 1}), UnknownIdError);
    EXPECT_THROW(map.Fuse(point, PointId(id)), UnknownIdError);
    EXPECT_THROW(map.Erase(PointId(id)), UnknownIdError);
    EXPECT_THROW(map.SetEnds(LineId(id), {0, 0, 1}, {0, 0, 2}), UnknownIdError);
    EXPECT_THROW(map.SetManhattan(ManhattanId(id), Eigen::Quaterniond::Identity()), UnknownIdError);
    EXPECT_EQ(map.Find(PointId(id)), nullptr);
    EXPECT_FALSE(map.Resolve(PointId(id)).IsValid());
    EXPECT_FALSE(map.LivingAncestor(KeyframeId(id)).IsValid());
    SE3 pose;
    EXPECT_FALSE(map.CamFromWorld(KeyframeId(id), &pose));
    EXPECT_TRUE(map.Covisible(KeyframeId(id), 1).empty());
  }
  EXPECT_EQ(CheckInvariants(map), std::nullopt);
  EXPECT_NE(map.Find(point), nullptr);
}

TEST(Map, WithAManhattanFrameGoTheAxesOfItsLines) {
  OwnedMap map;
  std::vector<ManhattanId> frames;
  std::vector<LineId> lines;
  for (const int k : {0, 1}) {
    Keyframe keyframe;
    keyframe.id = KeyframeId(k);
    keyframe.map = MapId(0);
    if (k > 0) keyframe.parent = KeyframeId(0);
    map.Insert(keyframe);
    frames.push_back(map.CreateManhattan(MapId(0), Eigen::Quaterniond::Identity()));
    map.SetManhattanOf(keyframe.id, frames.back());
    lines.push_back(map.CreateLine(MapId(0), keyframe.id, {0, 0, 1}, {1, 0, 1}));
    map.SetAxis(lines.back(), frames.back(), 0);
  }
  MapReplica replica;
  for (const MapDelta& delta : map.TakeDeltas({}, {})) ASSERT_TRUE(replica.Apply(delta));
  EXPECT_EQ(replica.Find(lines[0])->axis, 0);
  map.EraseManhattan(frames[0]);
  // A frame that is found later may have its axes in another order.
  const Eigen::Quaterniond renamed(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY()));
  map.CreateManhattan(MapId(0), renamed);
  for (const MapDelta& delta : map.TakeDeltas({}, {})) ASSERT_TRUE(replica.Apply(delta));
  for (const Map* each : std::initializer_list<const Map*>{&map, &replica}) {
    EXPECT_EQ(each->Find(lines[0])->axis, -1);
    EXPECT_FALSE(each->Find(KeyframeId(0))->manhattan.IsValid());
    EXPECT_EQ(each->Find(lines[1])->axis, 0) << "the other frame stays, and what belongs to it";
    EXPECT_EQ(each->Find(KeyframeId(1))->manhattan, frames[1]);
    EXPECT_EQ(CheckInvariants(*each), std::nullopt);
  }
}

TEST(Map, CompactionForgetsWhatWasFusedLongAgo) {
  RandomMap random(7);
  MapReplica replica;
  std::vector<PointId> fused;
  for (int step = 0; step < 40; ++step) {
    const PointId before(EndOf(random.map.points()) - 1);
    random.Step();
    if (!random.map.Find(before) && random.map.Resolve(before).IsValid()) fused.push_back(before);
    for (const MapDelta& d : random.map.TakeDeltas({}, {})) ASSERT_TRUE(replica.Apply(d));
  }
  random.map.Compact(random.map.version());
  for (const MapDelta& d : random.map.TakeDeltas({}, {})) ASSERT_TRUE(replica.Apply(d));
  MapReplica late;
  for (const MapDelta& d : random.map.Snapshot()) ASSERT_TRUE(late.Apply(d));
  for (const PointId id : fused) {
    for (const Map* each : std::initializer_list<const Map*>{&random.map, &replica, &late}) {
      EXPECT_FALSE(each->Resolve(id).IsValid());
    }
  }
}

TEST(Map, FusedPointsForward) {
  OwnedMap map;
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
  OwnedMap map;
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
