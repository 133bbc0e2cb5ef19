#include "frontend/loss_bridge.h"

#include <map>
#include <vector>

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
    frame.PlaceIn(map, s.TruthOf(frame));
    s.MatchAll(&frame);
    EXPECT_TRUE(frame.placement.HangOn(s.map.map, reference));
    return frame;
  }
  Frame Before(double x, int64_t seq) {
    return In(MapId(0), s.NewFrame(PoseAt({x, 0, 0}), seq), KeyframeId(2));
  }
  Frame After(const Frame& before) const { return In(MapId(1), before, KeyframeId(3)); }
  static LossBridge CrossingFrom(const std::vector<Frame>& frames) {
    LossBridge bridge;
    for (const Frame& frame : frames) bridge.Keep(frame);
    bridge.Break();
    bridge.Cross();
    return bridge;
  }

  TrackingScene s{1, {}};
};

TEST_F(LossBridgeTest, AFrameFromBeforeTheLossMakesASeam) {
  const Frame before = Before(0.6, 101);
  const LossBridge bridge = CrossingFrom({before});
  const auto seam = bridge.SeamAt(s.map.map, After(before));
  ASSERT_TRUE(seam);
  EXPECT_EQ(seam->map, MapId(0));
  EXPECT_LT(LocalCoordinates(seam->cam_from_world, s.TruthOf(before)).norm(), 1e-9);
  ASSERT_GE(seam->points.size(), 100u);
  EXPECT_EQ(static_cast<int>(seam->points.size()), TrackingScene::NumMatched(before));
  for (const auto& [feature, point] : seam->points)
    EXPECT_EQ(point, before.placement.points()[feature]);
}

TEST_F(LossBridgeTest, TheNearEndIsToBePlacedInTheNewMap) {
  const std::vector<Frame> before{Before(0.2, 101), Before(0.5, 102)};
  LossBridge bridge;
  for (const Frame& frame : before) bridge.Keep(frame);
  bridge.Break();
  const std::vector<Frame> near_end = bridge.Cross();
  ASSERT_EQ(near_end.size(), 2u);
  for (size_t i = 0; i < near_end.size(); ++i) {
    EXPECT_EQ(near_end[i].seen, before[i].seen);
    EXPECT_EQ(TrackingScene::NumMatched(near_end[i]), 0);
  }
}

TEST_F(LossBridgeTest, FramesOfTheLossDoNotCross) {
  const Frame before = Before(0.6, 101), lost = Before(0.7, 102);
  LossBridge bridge;
  bridge.Keep(before);
  bridge.Break();
  EXPECT_FALSE(bridge.Has(before)) << "there is no new map yet";
  EXPECT_FALSE(bridge.SeamAt(s.map.map, After(before)));
  bridge.Cross();
  EXPECT_TRUE(bridge.Has(before));
  EXPECT_FALSE(bridge.Has(lost));
  EXPECT_FALSE(bridge.SeamAt(s.map.map, After(lost)));
}

TEST_F(LossBridgeTest, WhatCrossesGoesOnBehindAnotherLoss) {
  const Frame before = Before(0.6, 101), later = Before(0.7, 201);
  LossBridge bridge = CrossingFrom({before});
  bridge.Keep(later);
  bridge.Break();
  EXPECT_TRUE(bridge.SeamAt(s.map.map, After(before)));
  bridge.ForgetNearEnd();
  EXPECT_TRUE(bridge.Has(before)) << "found again, but the walk goes on";
  bridge.Keep(later);
  bridge.Break();
  EXPECT_EQ(bridge.Cross().size(), 1u);
  EXPECT_TRUE(bridge.Has(before));
  EXPECT_TRUE(bridge.Has(later));
  bridge.EndCrossing();
  EXPECT_FALSE(bridge.Has(before));
  EXPECT_FALSE(bridge.Has(later));
}

TEST_F(LossBridgeTest, TheMapsMayMoveMeetAndGo) {
  const Frame before = Before(0.6, 101);
  const LossBridge bridge = CrossingFrom({before});
  Frame after = After(before);
  const Sim3 elsewhere{ExpSo3({0.5, 1, -0.5}), {1, 2, 3}, 4};
  s.map.map.Transform(MapId(0), elsewhere);
  const auto seam = bridge.SeamAt(s.map.map, after);
  ASSERT_TRUE(seam);
  EXPECT_LT((seam->cam_from_world.Center() - elsewhere * s.TruthOf(before).Center()).norm(), 1e-9);

  OwnedMap gone = s.map.map;
  gone.EraseMap(MapId(0));
  EXPECT_FALSE(bridge.SeamAt(gone, after));
  s.map.map.Absorb(MapId(0), MapId(1));
  EXPECT_FALSE(bridge.SeamAt(s.map.map, after)) << "they met";
}

TEST_F(LossBridgeTest, WhatIsForgottenIsGone) {
  const Frame before = Before(0.6, 101);
  LossBridge bridge;
  bridge.Keep(before);
  bridge.Break();
  bridge.ForgetNearEnd();
  EXPECT_TRUE(bridge.Cross().empty());

  bridge.Keep(before);
  bridge.ForgetKept();
  bridge.Break();
  EXPECT_TRUE(bridge.Cross().empty());

  for (int i = 0; i < 140; ++i) {
    bridge.Keep(Before(0.6, i));
  }
  bridge.Break();
  const std::vector<Frame> near_end = bridge.Cross();
  ASSERT_FALSE(near_end.empty());
  EXPECT_LE(near_end.size(), 100u);
  EXPECT_EQ(near_end.back().seq(), 139) << "the last are kept";
}

}  // namespace
}  // namespace vpslam
