#include "frontend/seam_finder.h"

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/unit/synthetic_lines.h"

namespace vpslam {
namespace {

/// Map 0 and map 1 show one place, from keyframes 0 to 2 and 3 to 5. Both know all points and lines
/// that two of their keyframes show. A frame is tracked in map 1.
class SeamFinderTest : public ::testing::Test {
 protected:
  SeamFinderTest() {
    AddLines({KeyframeId(0), KeyframeId(1), KeyframeId(2)});
    m.map.map_id = MapId(1);
    std::vector<KeyframeId> of_map_1;
    for (int i = 0; i < 3; ++i) of_map_1.push_back(m.AddKeyframe(PoseAt({0.1 + 0.2 * i, 0, 0})));
    for (int p = 0; p < static_cast<int>(m.scene.points.size()); ++p) m.map.AddPoint(p, of_map_1);
    AddLines(of_map_1);
  }
  void AddLines(const std::vector<KeyframeId>& keyframes) {
    for (int l = 0; l < static_cast<int>(m.lines.lines.size()); ++l) m.AddLine(l, keyframes);
  }
  /// With all points of `map` that it shows and, if asked for, all lines.
  Frame TrackedIn(MapId map, bool with_lines) {
    const SyntheticView view = m.scene.Look(pose);
    const SyntheticSegments seen = m.lines.Look(m.scene.camera, pose);
    Frame frame;
    frame.seen = FrameObservation::Make(0, 0, view.features, m.scene.bounds,
                                        std::make_shared<const LineSet>(seen.set));
    frame.PlaceIn(map, pose);
    for (const auto& [id, p] : m.map.truth) {
      const int feature = view.FeatureOf(p);
      if (feature >= 0) frame.placement.Match(feature, *m.map.map.Find(id));
    }
    for (const LineId id : m.Lines()) {
      const int segment = seen.SegmentOf(m.TruthOf(id));
      if (with_lines && segment >= 0) frame.placement.Match(segment, *m.map.map.Find(id));
    }
    return frame;
  }
  std::optional<MapSeam> Look(const Frame& frame) const {
    std::mt19937_64 rng(1);
    const TrackerOptions options;
    Relocalizer relocalizer(options);
    const TrackingContext context{m.scene.camera, m.scene.bounds, m.scene.scales, m.map.map};
    return SeamFinder(options.seams).Look(context, frame, MapId(), rng, &relocalizer);
  }

  SyntheticLineMap m{1, {.num_free = 80}, PosesSideBySide(3, 0.2), {.num_points = 600}};
  const SE3 pose = PoseAt({0.25, 0.1, 0.05}, {0.01, -0.02, 0});
};

TEST_F(SeamFinderTest, FindsTheFrameInTheOtherMap) {
  const Frame frame = TrackedIn(MapId(1), false);
  const auto seam = Look(frame);
  ASSERT_TRUE(seam);
  EXPECT_EQ(seam->map, MapId(0));
  // Each of more than 100 points says where the camera is to 5 x 1.5 px / 520; shifts and turns
  // look alike. Four sigma.
  EXPECT_LT((seam->cam_from_world.Center() - pose.Center()).norm(), 4 * 3 * 5 * 1.5 / 520 / 10);
  EXPECT_GE(seam->points.size(), 100u);
  for (const auto& [feature, point] : seam->points) {
    EXPECT_EQ(m.map.map.Find(point)->map, MapId(0));
  }
}

TEST_F(SeamFinderTest, LinesOfThePresentMapSayNothingOfTheOther) {
  const auto expect_the_same = [](const std::optional<MapSeam>& a,
                                  const std::optional<MapSeam>& b) {
    ASSERT_TRUE(a && b);
    EXPECT_EQ(a->map, b->map);
    EXPECT_EQ(a->cam_from_world.translation, b->cam_from_world.translation);
    EXPECT_EQ(a->cam_from_world.rotation.coeffs(), b->cam_from_world.rotation.coeffs());
    ASSERT_EQ(a->points.size(), b->points.size());
    for (size_t i = 0; i < a->points.size(); ++i) {
      EXPECT_EQ(a->points[i].feature, b->points[i].feature);
      EXPECT_EQ(a->points[i].landmark, b->points[i].landmark);
    }
  };
  const Frame with_lines = TrackedIn(MapId(1), true);
  const std::vector<LineId>& lines = with_lines.placement.lines();
  ASSERT_GT(std::count_if(lines.begin(), lines.end(), [](LineId id) { return id.IsValid(); }), 10);
  Frame without_lines = with_lines;
  for (size_t i = 0; i < lines.size(); ++i) {
    without_lines.placement.UnmatchLine(static_cast<int>(i));
  }
  expect_the_same(Look(with_lines), Look(without_lines));
  // Also where the two maps have different coordinates.
  m.map.map.Transform(MapId(1), {ExpSo3({0.05, 0.1, -0.1}), {0.3, -0.2, 0.1}, 1.1});
  expect_the_same(Look(with_lines), Look(without_lines));
}

TEST_F(SeamFinderTest, ASeamHasPointsOfOneMap) {
  // A keyframe of map 0 that observes points of map 1: no map should be so, but a seam would carry
  // the mistake on.
  const KeyframeId keyframe(1);
  std::map<int, PointId> in_map_0;
  for (const auto& [id, p] : m.map.truth) {
    if (m.map.map.Find(id)->map == MapId(0)) in_map_0[p] = id;
  }
  int wrong = 0;
  for (const auto& [id, p] : std::map(m.map.truth)) {
    const int feature = m.map.views.at(keyframe).FeatureOf(p);
    if (m.map.map.Find(id)->map == MapId(0) || feature < 0 || p % 3 > 0) continue;
    if (in_map_0.contains(p)) {
      m.map.map.Erase(in_map_0.at(p));
      m.map.truth.erase(in_map_0.at(p));
    }
    m.map.map.Observe(keyframe, feature, id);
    ++wrong;
  }
  ASSERT_GT(wrong, 0);
  const auto seam = Look(TrackedIn(MapId(1), true));
  ASSERT_TRUE(seam);
  EXPECT_EQ(seam->map, MapId(0));
  for (const auto& [feature, point] : seam->points) {
    EXPECT_EQ(m.map.map.Find(point)->map, MapId(0));
  }
}

}  // namespace
}  // namespace vpslam
