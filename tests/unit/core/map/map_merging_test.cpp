#include <map>

#include <gtest/gtest.h>

#include "core/map/invariants.h"
#include "core/map/map_replica.h"
#include "core/map/owned_map.h"
#include "random_map.h"

namespace vpslam {
namespace {

const Sim3 kSomewhereElse{ExpSo3({0.3, -0.8, 0.4}), {1, -2, 3}, 2.5};

/// Two maps, each with culled keyframes.
RandomMap TwoMaps() {
  RandomMap random(3);
  for (int i = 0; i < 30; ++i) random.Step();
  random.grows = MapId(1);
  for (int i = 0; i < 30; ++i) random.Step();
  EXPECT_GT(random.map.NumKeyframes(MapId(0)), 10);
  EXPECT_LT(random.map.NumKeyframes(MapId(1)), 30) << "some are culled";
  return random;
}

TEST(MapMerging, TransformMovesAllOfOneMapAndNothingElse) {
  RandomMap random = TwoMaps();
  OwnedMap& map = random.map;
  for (int32_t p = 0; p < EndOf(map.points()); ++p) {
    if (map.Find(PointId(p))) map.SetView(PointId(p), {0, 0, 1}, 4);
  }
  const OwnedMap before = map;
  map.Transform(MapId(1), kSomewhereElse);
  for (int32_t k = 0; k < KeyframeEnd(map); ++k) {
    SE3 was, is;
    if (!before.CamFromWorld(KeyframeId(k), &was)) continue;
    ASSERT_TRUE(map.CamFromWorld(KeyframeId(k), &is));
    const bool moves = before.FindEvenCulled(KeyframeId(k))->map == MapId(1);
    const Eigen::Vector3d center = moves ? kSomewhereElse * was.Center() : was.Center();
    EXPECT_NEAR((is.Center() - center).norm(), 0, 1e-9) << k;
  }
  for (int32_t p = 0; p < EndOf(map.points()); ++p) {
    const MapPoint* was = before.Find(PointId(p));
    if (!was) continue;
    const MapPoint& is = *map.Find(PointId(p));
    if (was->map == MapId(0)) {
      EXPECT_EQ(is.position, was->position);
      EXPECT_EQ(is.max_distance, was->max_distance);
      continue;
    }
    EXPECT_NEAR((is.normal - kSomewhereElse.rotation * was->normal).norm(), 0, 1e-9);
    EXPECT_EQ(is.max_distance, kSomewhereElse.scale * was->max_distance);
    // Where cameras see it stays, and so do distances in units of the map.
    for (const Observation& o : was->observations) {
      const Eigen::Vector3d in_cam = before.Find(o.keyframe)->cam_from_world * was->position;
      const Eigen::Vector3d now = map.Find(o.keyframe)->cam_from_world * is.position;
      EXPECT_NEAR((now - kSomewhereElse.scale * in_cam).norm(), 0, 1e-9);
    }
  }
}

TEST(MapMerging, WhatHangsOnAKeyframeFollows) {
  RandomMap random = TwoMaps();
  OwnedMap& map = random.map;
  const SE3 frame(ExpSo3({0.1, 0.2, 0.3}), Eigen::Vector3d(4, 5, 6));
  std::map<KeyframeId, SE3> hung;
  for (int32_t k = 0; k < KeyframeEnd(map); ++k) {
    const KeyframeNode* keyframe = map.FindEvenCulled(KeyframeId(k));
    if (keyframe && keyframe->map == MapId(1)) {
      ASSERT_TRUE(map.Hang(keyframe->id, frame, &hung[keyframe->id]));
    }
  }
  ASSERT_GT(hung.size(), 10u);
  // Twice, with a keyframe from in between.
  map.Transform(MapId(1), kSomewhereElse);
  random.Step();
  const KeyframeId between(KeyframeEnd(map) - 1);
  const SE3 once = TransformWorld(frame, kSomewhereElse);
  ASSERT_TRUE(map.Hang(between, once, &hung[between]));
  map.Transform(MapId(1), kSomewhereElse);
  const SE3 twice = TransformWorld(once, kSomewhereElse);
  for (const auto& [keyframe, cam_from_reference] : hung) {
    SE3 placed;
    ASSERT_TRUE(map.Place(keyframe, cam_from_reference, &placed));
    EXPECT_NEAR(LocalCoordinates(placed, twice).norm(), 0, 1e-9) << keyframe.value;
    SE3 again;
    ASSERT_TRUE(map.Hang(keyframe, placed, &again));
    EXPECT_NEAR(LocalCoordinates(again, cam_from_reference).norm(), 0, 1e-9);
  }
  SE3 placed;
  EXPECT_FALSE(map.Place(KeyframeId(9999), SE3(), &placed));
  EXPECT_FALSE(map.Hang(KeyframeId(-1), SE3(), &placed));
}

TEST(MapMerging, AnAbsorbedMapIsPartOfTheOther) {
  RandomMap random = TwoMaps();
  OwnedMap& map = random.map;
  const int keyframes = map.NumKeyframes(MapId(0)) + map.NumKeyframes(MapId(1));
  const int points = map.NumPoints(MapId(0)) + map.NumPoints(MapId(1));
  map.Absorb(MapId(1), MapId(0));
  EXPECT_EQ(map.NumKeyframes(MapId(0)), keyframes);
  EXPECT_EQ(map.NumPoints(MapId(0)), points);
  EXPECT_EQ(map.NumKeyframes(MapId(1)) + map.NumPoints(MapId(1)), 0);
  EXPECT_EQ(map.Resolve(MapId(1)), MapId(0));
  EXPECT_EQ(map.Resolve(MapId(0)), MapId(0));
  EXPECT_EQ(CheckInvariants(map), std::nullopt);
  EXPECT_EQ(map.num_merged(), 1);
}

TEST(MapMerging, ReplicasFollowByDeltasAndBySnapshot) {
  RandomMap random = TwoMaps();
  OwnedMap& owner = random.map;
  MapReplica replica;
  for (const MapDelta& d : owner.TakeDeltas(KeyframeId(), {})) ASSERT_TRUE(replica.Apply(d));
  owner.Transform(MapId(1), kSomewhereElse);
  owner.Absorb(MapId(1), MapId(0));
  for (const MapDelta& d : owner.TakeDeltas(KeyframeId(), {})) ASSERT_TRUE(replica.Apply(d));
  MapReplica late;
  for (const MapDelta& d : owner.Snapshot()) ASSERT_TRUE(late.Apply(d));
  for (const Map* map : std::initializer_list<const Map*>{&replica, &late}) {
    EXPECT_EQ(map->NumKeyframes(MapId(0)), owner.NumKeyframes(MapId(0)));
    EXPECT_EQ(map->NumPoints(MapId(0)), owner.NumPoints(MapId(0)));
    EXPECT_EQ(map->NumKeyframes(MapId(1)) + map->NumPoints(MapId(1)), 0);
    EXPECT_EQ(map->Resolve(MapId(1)), MapId(0));
    EXPECT_EQ(CheckInvariants(*map), std::nullopt);
    const SE3 relative(ExpSo3({0.1, 0, 0}), Eigen::Vector3d(1, 2, 3));
    for (int32_t k = 0; k < KeyframeEnd(owner); ++k) {
      SE3 a, b;
      ASSERT_EQ(owner.Place(KeyframeId(k), relative, &a), map->Place(KeyframeId(k), relative, &b));
      EXPECT_NEAR(LocalCoordinates(a, b).norm(), 0, 1e-9);
    }
    for (int32_t p = 0; p < EndOf(owner.points()); ++p) {
      const MapPoint* point = owner.Find(PointId(p));
      ASSERT_EQ(point == nullptr, map->Find(PointId(p)) == nullptr);
      if (!point) continue;
      EXPECT_NEAR((point->position - map->Find(PointId(p))->position).norm(), 0, 1e-5);
    }
  }
}

TEST(MapMerging, MergersInACircleAreSurvived) {
  MapDelta delta;
  delta.version = 1;
  delta.merged_maps = {{MapId(0), MapId(1)}, {MapId(1), MapId(0)}};
  MapReplica map;
  ASSERT_TRUE(map.Apply(delta));
  EXPECT_TRUE(map.Resolve(MapId(0)).IsValid());
}

}  // namespace
}  // namespace vpslam
