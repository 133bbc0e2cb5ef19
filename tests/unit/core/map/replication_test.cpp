#include <gtest/gtest.h>

#include "core/map/map.h"
#include "random_map.h"

namespace vpslam {
namespace {

void ExpectSame(const Map& owner, const Map& replica) {
  ASSERT_EQ(owner.version(), replica.version());
  ASSERT_EQ(owner.NumKeyframes(MapId(0)), replica.NumKeyframes(MapId(0)));
  ASSERT_EQ(owner.NumPoints(MapId(0)), replica.NumPoints(MapId(0)));
  for (int32_t i = 0; i < owner.point_end(); ++i) {
    const MapPoint* a = owner.Find(PointId(i));
    const MapPoint* b = replica.Find(PointId(i));
    ASSERT_EQ(a == nullptr, b == nullptr);
    ASSERT_EQ(owner.Resolve(PointId(i)), replica.Resolve(PointId(i)));
    if (!a) continue;
    ASSERT_NEAR((a->position - b->position).norm(), 0, 1e-6);
    ASSERT_EQ(a->observations.size(), b->observations.size());
    for (size_t k = 0; k < a->observations.size(); ++k) {
      ASSERT_EQ(a->observations[k].keyframe, b->observations[k].keyframe);
      ASSERT_EQ(a->observations[k].feature, b->observations[k].feature);
    }
  }
  ASSERT_EQ(owner.NumLines(MapId(0)), replica.NumLines(MapId(0)));
  for (int32_t i = 0; i < owner.line_end(); ++i) {
    const MapLine* a = owner.Find(LineId(i));
    const MapLine* b = replica.Find(LineId(i));
    ASSERT_EQ(a == nullptr, b == nullptr);
    ASSERT_EQ(owner.Resolve(LineId(i)), replica.Resolve(LineId(i)));
    if (!a) continue;
    ASSERT_NEAR((a->start - b->start).norm() + (a->end - b->end).norm(), 0, 1e-6);
    ASSERT_EQ(a->axis, b->axis);
    ASSERT_EQ(a->observations.size(), b->observations.size());
  }
  const auto frame = owner.WorldFromManhattan(MapId(0));
  const auto replicated = replica.WorldFromManhattan(MapId(0));
  ASSERT_EQ(frame.has_value(), replicated.has_value());
  if (frame) {
    ASSERT_EQ(frame->coeffs(), replicated->coeffs());
  }
  for (int32_t i = 0; i < owner.keyframe_end(); ++i) {
    SE3 a, b;
    ASSERT_EQ(owner.CamFromWorld(KeyframeId(i), &a), replica.CamFromWorld(KeyframeId(i), &b));
    ASSERT_NEAR(LocalCoordinates(a, b).norm(), 0, 1e-9);
  }
}

TEST(Replication, DeltasReproduceTheMap) {
  RandomMap random(1);
  Map replica;
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
  Map replica;
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
    EXPECT_LT(parts[i].appearances.size() * 48 + parts[i].geometries.size() * 32, 50'000u);
  }
}

TEST(Replication, AnErasedMapIsGoneInReplicasToo) {
  RandomMap random(4);
  for (int step = 0; step < 5; ++step) random.Step();
  Map replica;
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
