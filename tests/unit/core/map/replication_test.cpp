#include <gtest/gtest.h>

#include "core/map/invariants.h"
#include "core/map/map_replica.h"
#include "core/map/owned_map.h"
#include "core/messages/array_lengths.h"
#include "random_map.h"
#include "tests/unit/table_end.h"

namespace vpslam {
namespace {

template <class Landmark>
void ExpectSameLandmark(const Landmark& a, const Landmark& b) {
  ASSERT_EQ(a.id, b.id);
  ASSERT_EQ(a.map, b.map);
  ASSERT_EQ(a.reference, b.reference);
  ASSERT_EQ(a.observations, b.observations);
  ASSERT_EQ(a.descriptor, b.descriptor);
}

void ExpectSame(const OwnedMap& owner, const Map& replica) {
  ASSERT_EQ(CheckInvariants(replica), std::nullopt);
  ASSERT_EQ(owner.version(), replica.version());
  ASSERT_EQ(owner.Maps(), replica.Maps());
  ASSERT_EQ(owner.latest_session(), replica.latest_session());
  ASSERT_EQ(owner.points().size(), replica.points().size());
  for (const MapPoint& a : owner.points()) {
    const MapPoint* b = replica.Find(a.id);
    ASSERT_NE(b, nullptr);
    ExpectSameLandmark(a, *b);
    ASSERT_EQ(a.position, b->position);
    ASSERT_EQ(a.normal, b->normal);
    ASSERT_EQ(a.max_distance, b->max_distance);
  }
  for (int i = 0; i < EndOf(owner.points()); ++i) {
    ASSERT_EQ(owner.Resolve(PointId(i)), replica.Resolve(PointId(i)));
  }
  ASSERT_EQ(owner.lines().size(), replica.lines().size());
  for (const MapLine& a : owner.lines()) {
    const MapLine* b = replica.Find(a.id);
    ASSERT_NE(b, nullptr);
    ExpectSameLandmark(a, *b);
    ASSERT_EQ(a.start, b->start);
    ASSERT_EQ(a.end, b->end);
    ASSERT_EQ(a.manhattan, b->manhattan);
    ASSERT_EQ(a.axis, b->axis);
  }
  for (int i = 0; i < EndOf(owner.lines()); ++i) {
    ASSERT_EQ(owner.Resolve(LineId(i)), replica.Resolve(LineId(i)));
  }
  for (const MapId map : owner.Maps()) {
    const auto ours = owner.ManhattanFrames(map), theirs = replica.ManhattanFrames(map);
    ASSERT_EQ(ours.size(), theirs.size());
    for (size_t i = 0; i < ours.size(); ++i) {
      ASSERT_EQ(ours[i].id, theirs[i].id);
      ASSERT_EQ(ours[i].world_from_manhattan.coeffs(), theirs[i].world_from_manhattan.coeffs());
    }
  }
  ASSERT_EQ(owner.keyframes().size(), replica.keyframes().size());
  ASSERT_EQ(owner.culled_keyframes().size(), replica.culled_keyframes().size());
  for (int i = 0; i < KeyframeEnd(owner); ++i) {
    const KeyframeNode* a = owner.FindEvenCulled(KeyframeId(i));
    const KeyframeNode* b = replica.FindEvenCulled(KeyframeId(i));
    ASSERT_EQ(a == nullptr, b == nullptr);
    if (!a) continue;
    ASSERT_EQ(a->map, b->map);
    ASSERT_EQ(a->frame_seq, b->frame_seq);
    ASSERT_EQ(a->culled, b->culled);
    ASSERT_EQ(a->parent, b->parent);
    ASSERT_EQ(a->unit, b->unit);
    SE3 pose, replicated;
    ASSERT_TRUE(owner.CamFromWorld(a->id, &pose));
    ASSERT_TRUE(replica.CamFromWorld(a->id, &replicated));
    ASSERT_EQ(pose.translation, replicated.translation);
    ASSERT_EQ(pose.rotation.coeffs(), replicated.rotation.coeffs());
    if (a->culled) continue;
    ASSERT_EQ(owner.Find(a->id)->manhattan, replica.Find(a->id)->manhattan);
    ASSERT_EQ(owner.Find(a->id)->covisible, replica.Find(a->id)->covisible);
  }
}

/// On the wire, of all lists.
size_t Bytes(const MapDelta& d) {
  const auto of = [](const auto& list) {
    return list.size() * WireBytes<typename std::decay_t<decltype(list)>::value_type>();
  };
  size_t bytes = of(d.erased_maps) + of(d.merged_maps) + of(d.keyframes) + of(d.appearances) +
                 of(d.geometries) + of(d.tombstones) + of(d.lines) + of(d.line_tombstones) +
                 of(d.manhattan_frames) + of(d.forgotten_points) + of(d.forgotten_lines);
  for (const KeyframeState& k : d.keyframes) bytes += of(k.points) + of(k.lines);
  return bytes;
}

TEST(Replication, DeltasReproduceTheMap) {
  RandomMap random(1);
  MapReplica replica;
  for (int step = 0; step < 60; ++step) {
    random.Step();
    for (const MapDelta& delta : random.map.TakeDeltas(KeyframeId(step), {})) {
      ASSERT_TRUE(replica.Apply(delta));
    }
    ExpectSame(random.map, replica);
  }
}

TEST(Replication, AMissedDeltaIsRefusedAndASnapshotCatchesUp) {
  RandomMap random(2);
  MapReplica replica;
  random.Step();
  for (const MapDelta& delta : random.map.TakeDeltas(KeyframeId(0), {})) {
    ASSERT_TRUE(replica.Apply(delta));
  }
  random.Step();
  random.map.TakeDeltas(KeyframeId(1), {});  // lost
  random.Step();
  const int64_t before = replica.version();
  for (const MapDelta& delta : random.map.TakeDeltas(KeyframeId(2), {})) {
    EXPECT_FALSE(replica.Apply(delta));
  }
  EXPECT_EQ(replica.version(), before);
  const std::vector<MapDelta> snapshot = random.map.Snapshot();
  EXPECT_TRUE(snapshot.front().snapshot);
  for (const MapDelta& delta : snapshot) ASSERT_TRUE(replica.Apply(delta));
  ExpectSame(random.map, replica);
  random.Step();
  for (const MapDelta& delta : random.map.TakeDeltas(KeyframeId(99), {})) {
    ASSERT_TRUE(replica.Apply(delta));
  }
  ExpectSame(random.map, replica);
}

TEST(Replication, LargeChangesAreCutIntoPartsOfOneDatagram) {
  RandomMap random(3);
  for (int step = 0; step < 120; ++step) random.Step();
  const std::vector<MapDelta> parts = random.map.TakeDeltas(KeyframeId(7), {});
  ASSERT_GT(parts.size(), 2u);
  for (size_t i = 0; i < parts.size(); ++i) {
    EXPECT_EQ(parts[i].answers.IsValid(), i + 1 == parts.size());
    EXPECT_EQ(parts[i].base_version, static_cast<int64_t>(i));
    EXPECT_LT(Bytes(parts[i]), 50'000u);
  }
}

TEST(Replication, WhatSpeaksOfTheUnknownIsRefusedUntilASnapshotComes) {
  RandomMap random(5);
  MapReplica replica;
  random.Step();
  for (const MapDelta& delta : random.map.TakeDeltas({}, {})) ASSERT_TRUE(replica.Apply(delta));
  MapDelta alien;
  alien.base_version = replica.version();
  alien.version = alien.base_version + 1;
  alien.geometries.push_back({PointId(1 << 20), {0, 0, 1}, {0, 0, 1}, 1});
  EXPECT_FALSE(replica.Apply(alien));
  random.Step();
  for (const MapDelta& delta : random.map.TakeDeltas({}, {})) EXPECT_FALSE(replica.Apply(delta));
  for (const MapDelta& delta : random.map.Snapshot()) ASSERT_TRUE(replica.Apply(delta));
  ExpectSame(random.map, replica);
}

TEST(Replication, AnErasedMapIsGoneInReplicasToo) {
  RandomMap random(4);
  for (int step = 0; step < 5; ++step) random.Step();
  MapReplica replica;
  for (const MapDelta& delta : random.map.TakeDeltas(KeyframeId(0), {})) replica.Apply(delta);
  random.map.EraseMap(MapId(0));
  for (const MapDelta& delta : random.map.TakeDeltas(KeyframeId(1), {})) {
    ASSERT_TRUE(replica.Apply(delta));
  }
  EXPECT_EQ(replica.NumKeyframes(MapId(0)), 0);
  EXPECT_EQ(replica.NumPoints(MapId(0)), 0);
}

}  // namespace
}  // namespace vpslam
