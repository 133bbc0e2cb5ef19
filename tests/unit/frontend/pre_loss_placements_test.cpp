#include "frontend/pre_loss_placements.h"

#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/frontend/tracking_scene.h"

namespace vpslam {
namespace {

/// Keyframes 0 to 2 of map 0 stand at 0 to 0.6, and 3 to 5 of map 1 at 0.9 to 1.5. Both know what
/// two of theirs show, in the same coordinates.
class PreLossPlacementsTest : public ::testing::Test {
 protected:
  PreLossPlacementsTest() {
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
  TrackingScene s{1, {}};
};

TEST_F(PreLossPlacementsTest, AFrameFromBeforeTheLossMakesASeam) {
  const Frame before = Before(0.6, 101);
  PreLossPlacements placements;
  placements.Add({before});
  const auto seam = placements.SeamAt(s.map.map, After(before));
  ASSERT_TRUE(seam);
  EXPECT_EQ(seam->map, MapId(0));
  EXPECT_LT(LocalCoordinates(seam->cam_from_world, s.TruthOf(before)).norm(), 1e-9);
  ASSERT_GE(seam->points.size(), 100u);
  EXPECT_EQ(static_cast<int>(seam->points.size()), TrackingScene::NumMatched(before));
  for (const auto& [feature, point] : seam->points)
    EXPECT_EQ(point, before.placement.points()[feature]);
}

TEST_F(PreLossPlacementsTest, FramesOfTheLossHaveNone) {
  const Frame before = Before(0.6, 101), lost = Before(0.7, 102), earlier = Before(0.5, 51);
  PreLossPlacements placements;
  EXPECT_FALSE(placements.Has(before));
  EXPECT_FALSE(placements.SeamAt(s.map.map, After(before)));
  placements.Add({before});
  EXPECT_TRUE(placements.Has(before));
  EXPECT_FALSE(placements.Has(lost));
  EXPECT_FALSE(placements.SeamAt(s.map.map, After(lost)));
  // Those of another loss come in addition.
  placements.Add({earlier});
  EXPECT_TRUE(placements.Has(before));
  EXPECT_TRUE(placements.Has(earlier));
  placements.Clear();
  EXPECT_FALSE(placements.Has(before));
  EXPECT_FALSE(placements.SeamAt(s.map.map, After(before)));
}

TEST_F(PreLossPlacementsTest, TheMapsMayMoveMeetAndGo) {
  const Frame before = Before(0.6, 101);
  PreLossPlacements placements;
  placements.Add({before});
  Frame after = After(before);
  const Sim3 elsewhere{ExpSo3({0.5, 1, -0.5}), {1, 2, 3}, 4};
  s.map.map.Transform(MapId(0), elsewhere);
  const auto seam = placements.SeamAt(s.map.map, after);
  ASSERT_TRUE(seam);
  EXPECT_LT((seam->cam_from_world.Center() - elsewhere * s.TruthOf(before).Center()).norm(), 1e-9);

  OwnedMap gone = s.map.map;
  gone.EraseMap(MapId(0));
  EXPECT_FALSE(placements.SeamAt(gone, after));
  s.map.map.Absorb(MapId(0), MapId(1));
  EXPECT_FALSE(placements.SeamAt(s.map.map, after)) << "they met";
}

}  // namespace
}  // namespace vpslam
