#include "frontend/loss_bridge.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/unit/frontend/tracking_scene.h"

namespace vpslam {
namespace {

/// Keyframes 0 to 2 of map 0 stand at 0 to 0.6, and 3 to 5 of map 1 at 0.9 to 1.5. Both know what
/// two of theirs show, in the same coordinates.
class LossBridgeTest : public ::testing::Test {
 protected:
  LossBridgeTest() {
    s.map.map_id = MapId(1);
    std::vector<KeyframeId> of_new_map;
    for (int i = 3; i < 6; ++i) {
      of_new_map.push_back(s.map.AddKeyframe(s.scene.Look(PoseAt({0.3 * i, 0, 0}))));
    }
    for (int p = 0; p < static_cast<int>(s.scene.points.size()); ++p) {
      s.map.AddPoint(p, of_new_map);
    }
  }

  /// With all points of the map that it shows.
  Frame In(MapId map, Frame frame, KeyframeId reference) const {
    std::map<int, PointId> id_of;
    for (const auto& [id, p] : s.map.truth) {
      if (s.map.map.Find(id)->map == map) id_of[p] = id;
    }
    for (int f = 0; f < frame.features.size(); ++f) {
      const auto at = id_of.find(s.PointOf(frame, f));
      frame.points[f] = at == id_of.end() ? PointId() : at->second;
    }
    frame.cam_from_world = s.TruthOf(frame);
    EXPECT_TRUE(HangOn(s.map.map, reference, &frame));
    return frame;
  }
  Frame Before(double x, int64_t seq) {
    return In(MapId(0), s.NewFrame(PoseAt({x, 0, 0}), seq), KeyframeId(2));
  }
  Frame After(const Frame& before) const { return In(MapId(1), before, KeyframeId(3)); }
  int Common(const Frame& before) const {
    const Frame after = After(before);
    int common = 0;
    for (int f = 0; f < before.features.size(); ++f) {
      common += before.points[f].IsValid() && after.points[f].IsValid();
    }
    return common;
  }

  TrackingScene s{1, {}};
  SeamOptions options;
};

TEST_F(LossBridgeTest, TheFrameThatShowsMostOfBothMakesTheSeam) {
  LossBridge bridge(options);
  // The farther to the right, the more of the new map; the last sees little of anything.
  std::vector<Frame> before{Before(0.2, 101), Before(0.5, 102), Before(0.7, 103), Before(0.7, 104)};
  for (int f = 30; f < before[3].features.size(); ++f) before[3].points[f] = PointId();
  for (const Frame& frame : before) bridge.Keep(frame);
  bridge.Break();

  std::vector<Frame> near_end = bridge.NearEnd();
  ASSERT_EQ(near_end.size(), 4u);
  for (size_t i = 0; i < near_end.size(); ++i) {
    EXPECT_EQ(near_end[i].seq, before[i].seq);
    EXPECT_EQ(TrackingScene::NumMatched(near_end[i]), 0);
  }
  EXPECT_FALSE(bridge.Take(s.map.map)) << "none is placed";
  int best = 0;
  for (int i = 3; i >= 0; --i) {
    EXPECT_TRUE(bridge.Offer(s.map.map, After(before[i])));
    if (Common(before[i]) > Common(before[best])) best = i;
  }
  ASSERT_GE(Common(before[best]), 100);
  const auto end = bridge.Take(s.map.map);
  ASSERT_TRUE(end);
  const auto& [frame, seam] = *end;
  EXPECT_EQ(frame.seq, before[best].seq);
  EXPECT_EQ(frame.reference, KeyframeId(3));
  EXPECT_EQ(seam.map, MapId(0));
  EXPECT_LT(LocalCoordinates(seam.cam_from_world, s.TruthOf(frame)).norm(), 1e-9);
  EXPECT_EQ(static_cast<int>(seam.points.size()), TrackingScene::NumMatched(before[best]));
  for (const auto& [feature, point] : seam.points) {
    EXPECT_EQ(point, before[best].points[feature]);
  }
  EXPECT_FALSE(bridge.Take(s.map.map)) << "once";
}

TEST_F(LossBridgeTest, FramesOfTheLossAreNotOfTheNearEnd) {
  LossBridge bridge(options);
  const Frame before = Before(0.6, 101);
  bridge.Keep(before);
  EXPECT_FALSE(bridge.Offer(s.map.map, After(before))) << "no loss";
  bridge.Break();
  EXPECT_FALSE(bridge.Offer(s.map.map, After(Before(0.7, 102))));
  EXPECT_TRUE(bridge.Offer(s.map.map, After(before)));
}

TEST_F(LossBridgeTest, AKeyframeOfTheOldMapStaysThere) {
  LossBridge bridge(options);
  const Frame keyframe = Before(0.6, 20);
  bridge.Keep(keyframe);
  bridge.Break();
  EXPECT_TRUE(bridge.Offer(s.map.map, After(keyframe)));
  EXPECT_FALSE(bridge.Take(s.map.map));
}

TEST_F(LossBridgeTest, FewCommonPointsAreNotEnough) {
  const Frame before = Before(0.6, 101);
  for (const int margin : {0, 1}) {
    options.min_common = Common(before) + margin;
    LossBridge bridge(options);
    bridge.Keep(before);
    bridge.Break();
    bridge.Offer(s.map.map, After(before));
    EXPECT_EQ(bridge.Take(s.map.map).has_value(), margin == 0);
  }
}

TEST_F(LossBridgeTest, TheMapsMayMoveMeetAndGo) {
  const Frame before = Before(0.6, 101);
  const Sim3 elsewhere{ExpSo3({0.5, 1, -0.5}), {1, 2, 3}, 4};
  LossBridge bridge(options);
  const auto offer = [&] {
    bridge.Keep(before);
    bridge.Break();
    EXPECT_TRUE(bridge.Offer(s.map.map, After(before)));
  };
  offer();
  s.map.map.Transform(MapId(1), elsewhere);
  const auto end = bridge.Take(s.map.map);
  ASSERT_TRUE(end);
  EXPECT_LT((end->first.cam_from_world.Center() - elsewhere * s.TruthOf(before).Center()).norm(),
            1e-9);
  EXPECT_LT(LocalCoordinates(end->second.cam_from_world, s.TruthOf(before)).norm(), 1e-9);

  s.map.map.Transform(MapId(1), elsewhere.Inverse());
  offer();
  s.map.map.Absorb(MapId(1), MapId(0));
  EXPECT_FALSE(bridge.Take(s.map.map)) << "they met";

  bridge.Keep(before);
  bridge.Break();
  s.map.map.EraseMap(MapId(0));
  EXPECT_FALSE(bridge.Take(s.map.map));
}

TEST_F(LossBridgeTest, WhatIsForgottenIsGone) {
  LossBridge bridge(options);
  const Frame before = Before(0.6, 101);
  bridge.Keep(before);
  bridge.Break();
  bridge.Offer(s.map.map, After(before));
  bridge.ForgetNearEnd();
  EXPECT_TRUE(bridge.NearEnd().empty());
  EXPECT_FALSE(bridge.Take(s.map.map));

  bridge.Keep(before);
  bridge.ForgetKept();
  bridge.Break();
  EXPECT_TRUE(bridge.NearEnd().empty());

  for (int i = 0; i < 40; ++i) {
    Frame frame = before;
    frame.seq = i;
    bridge.Keep(frame);
  }
  bridge.Break();
  const std::vector<Frame> near_end = bridge.NearEnd();
  ASSERT_FALSE(near_end.empty());
  EXPECT_LE(near_end.size(), 15u);
  EXPECT_EQ(near_end.back().seq, 39) << "the last are kept";
}

}  // namespace
}  // namespace vpslam
