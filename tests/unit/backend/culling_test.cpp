#include "backend/culling.h"

#include <gtest/gtest.h>

#include "tests/unit/synthetic_scene.h"

namespace vpslam {
namespace {

/// Keyframes side by side, all of which show all points of the map.
struct Fixture {
  explicit Fixture(int num_keyframes, int num_points = 800)
      : scene(1, {.num_points = num_points}), map(scene) {
    for (int i = 0; i < num_keyframes; ++i) {
      map.AddKeyframe(scene.Look(PoseAt({0.05 * i, 0, 0})));
    }
  }
  /// Points that the keyframes show.
  std::vector<int> SeenByAll() const {
    std::vector<int> result;
    for (int p = 0; p < static_cast<int>(scene.points.size()); ++p) {
      bool seen = true;
      for (const auto& [id, view] : map.views) seen = seen && view.FeatureOf(p) >= 0;
      if (seen) result.push_back(p);
    }
    return result;
  }
  int& Octave(KeyframeId keyframe, PointId point) {
    for (const Observation& o : map.map.Find(point)->observations) {
      if (o.keyframe == keyframe) {
        return map.FeaturesOf(keyframe).keypoints[o.feature].octave;
      }
    }
    throw std::logic_error("not observed");
  }

  SyntheticScene scene;
  SyntheticMap map;
};

std::vector<KeyframeId> Ids(std::initializer_list<int> values) {
  std::vector<KeyframeId> ids;
  for (const int v : values) ids.emplace_back(v);
  return ids;
}

TEST(PointProbation, TooSeldomFoundIsErased) {
  Fixture f(4);
  const std::vector<int> points = f.SeenByAll();
  PointProbation probation({.min_found_ratio = 0.25});
  const auto add = [&](int i) {
    const PointId id = f.map.AddPoint(points[i], Ids({0, 1, 2}));
    probation.Add(id, 3);
    return id;
  };
  const PointId found = add(0), missed = add(1), unseen = add(2), in_parts = add(3);
  // The observation that created it counts as seen and found: 2 of 8, and 2 of 9.
  probation.Count({found, 7, 1});
  probation.Count({missed, 8, 1});
  probation.Count({in_parts, 4, 0});
  probation.Count({in_parts, 4, 1});
  probation.Count({PointId(), 100, 0});
  probation.Count({PointId(7777), 100, 0});
  probation.Cull(4, &f.map.map);
  EXPECT_NE(f.map.map.Find(found), nullptr);
  EXPECT_NE(f.map.map.Find(unseen), nullptr);
  EXPECT_EQ(f.map.map.Find(missed), nullptr);
  EXPECT_EQ(f.map.map.Find(in_parts), nullptr);
}

TEST(PointProbation, TwoObservationsDoNotLast) {
  Fixture f(4);
  const std::vector<int> points = f.SeenByAll();
  PointProbation probation({});
  const PointId two = f.map.AddPoint(points[0], Ids({0, 1}));
  const PointId three = f.map.AddPoint(points[1], Ids({0, 1, 2}));
  const PointId unknown = f.map.AddPoint(points[2], Ids({0, 1}));
  probation.Add(two, 10);
  probation.Add(three, 10);
  probation.Cull(11, &f.map.map);
  EXPECT_NE(f.map.map.Find(two), nullptr);
  probation.Cull(12, &f.map.map);
  EXPECT_EQ(f.map.map.Find(two), nullptr);
  EXPECT_NE(f.map.map.Find(three), nullptr);
  EXPECT_NE(f.map.map.Find(unknown), nullptr) << "never on probation";
}

TEST(PointProbation, WhoPassedIsLeftAlone) {
  Fixture f(4);
  const std::vector<int> points = f.SeenByAll();
  PointProbation probation({});
  const PointId id = f.map.AddPoint(points[0], Ids({0, 1, 2}));
  probation.Add(id, 10);
  for (int count = 11; count <= 14; ++count) probation.Cull(count, &f.map.map);
  f.map.map.Unobserve(KeyframeId(2), id);
  probation.Count({id, 1000, 0});
  probation.Cull(15, &f.map.map);
  EXPECT_NE(f.map.map.Find(id), nullptr);
}

TEST(PointProbation, ForgetsPointsThatAreGone) {
  Fixture f(4);
  const std::vector<int> points = f.SeenByAll();
  PointProbation probation({});
  const PointId erased = f.map.AddPoint(points[0], Ids({0, 1}));
  const PointId fused = f.map.AddPoint(points[1], Ids({0, 1}));
  const PointId to = f.map.AddPoint(points[2], Ids({1, 2, 3}));
  probation.Add(erased, 4);
  probation.Add(fused, 4);
  f.map.map.Erase(erased);
  f.map.map.Fuse(fused, to);
  for (int count = 5; count < 9; ++count) probation.Cull(count, &f.map.map);
  EXPECT_EQ(f.map.map.Resolve(fused), to);
  EXPECT_EQ(f.map.map.NumPoints(MapId(0)), 1);
}

/// Of five keyframes number 2 is the one in question: `shared` of its points are seen by the first
/// `observers` of the others as well, and `own` by one other.
struct Redundancy {
  Redundancy(int shared, int observers, int own) : f(5, 1600) {
    const std::vector<int> points = f.SeenByAll();
    std::vector<KeyframeId> all = Ids({2});
    for (const int k : {4, 0, 1, 3}) {
      if (static_cast<int>(all.size()) <= observers) all.emplace_back(k);
    }
    std::sort(all.begin(), all.end());
    for (int i = 0; i < shared; ++i) of_many.push_back(f.map.AddPoint(points[i], all));
    for (int i = 0; i < own; ++i) f.map.AddPoint(points[shared + i], Ids({2, 4}));
    // Keeps the others from being redundant.
    int next = shared + own;
    for (const int k : {0, 1, 3}) {
      for (int i = 0; i < 30; ++i) f.map.AddPoint(points[next++], Ids({k, 4}));
    }
  }
  /// Every keyframe has plenty of points, unless it is said otherwise.
  std::vector<KeyframeId> Cull(const CullingOptions& options = {.plenty_points = 0}) {
    const int culled = CullKeyframes(KeyframeId(4), options, &f.map.map);
    std::vector<KeyframeId> gone;
    for (int i = 0; i < 5; ++i) {
      if (!f.map.map.Find(KeyframeId(i))) gone.emplace_back(i);
    }
    EXPECT_EQ(culled, static_cast<int>(gone.size()));
    return gone;
  }
  Fixture f;
  std::vector<PointId> of_many;
};

TEST(CullKeyframes, NineTenthsSeenByThreeOthers) {
  EXPECT_EQ(Redundancy(91, 3, 9).Cull(), Ids({2}));
  EXPECT_EQ(Redundancy(90, 3, 10).Cull(), Ids({})) << "more than nine tenths are asked for";
  EXPECT_EQ(Redundancy(100, 2, 0).Cull(), Ids({}));
  EXPECT_EQ(Redundancy(100, 4, 0).Cull(), Ids({2}));
}

TEST(CullKeyframes, CoarserObservationsDoNotReplaceFinerOnes) {
  for (const int coarser : {0, 1, 2}) {
    Redundancy r(100, 3, 0);
    for (const PointId id : r.of_many) {
      for (const int k : {0, 1, 2, 4}) r.f.Octave(KeyframeId(k), id) = k == 0 ? coarser : 0;
    }
    // One octave is what rounding leaves open.
    EXPECT_EQ(r.Cull(), coarser <= 1 ? Ids({2}) : Ids({})) << coarser;
  }
}

TEST(CullKeyframes, WhoShowsLittleIsNeededMore) {
  CullingOptions options{.plenty_points = 100, .scarcity_power = 2};
  EXPECT_EQ(Redundancy(100, 3, 0).Cull(options), Ids({2}));
  options.plenty_points = 120;  // 1.44 times 3 observers
  EXPECT_EQ(Redundancy(100, 3, 0).Cull(options), Ids({}));
  EXPECT_EQ(Redundancy(100, 4, 0).Cull(options), Ids({2}));
}

TEST(CullKeyframes, AtTheDefaultsWhatShowsLittleStays) {
  // Three others see each point. That is enough where there is plenty to see, and the fewer points
  // a keyframe shows the less it is enough.
  for (const int points : {1, 20, 31, 32, 100, 200}) {
    EXPECT_EQ(Redundancy(points, 3, 0).Cull(CullingOptions()), Ids({})) << points;
  }
  EXPECT_EQ(Redundancy(240, 3, 0).Cull(CullingOptions()), Ids({2}));
}

TEST(CullKeyframes, LinesCountForWhatAKeyframeShows) {
  const CullingOptions options{.plenty_points = 120, .scarcity_power = 2, .points_per_line = 4};
  Redundancy r(100, 3, 0);
  EXPECT_EQ(r.Cull(options), Ids({}));
  for (int segment = 0; segment < 5; ++segment) {
    const LineId line = r.f.map.map.CreateLine(MapId(0), KeyframeId(2), {0, 0, 5}, {1, 0, 5});
    r.f.map.map.Observe(KeyframeId(2), segment, line);
  }
  EXPECT_EQ(r.Cull(options), Ids({2}));
}

TEST(CullKeyframes, TheFirstAndTheNewStay) {
  Fixture f(5);
  for (const int p : f.SeenByAll()) f.map.AddPoint(p, Ids({0, 1, 2, 3, 4}));
  const int culled = CullKeyframes(KeyframeId(4), {.plenty_points = 0}, &f.map.map);
  // Five see each point. Two may go; of the three that remain, each is needed.
  EXPECT_EQ(culled, 2);
  EXPECT_NE(f.map.map.Find(KeyframeId(0)), nullptr);
  EXPECT_NE(f.map.map.Find(KeyframeId(4)), nullptr);
}

TEST(CullKeyframes, PosesThatHangOnTheCulledAreKept) {
  Redundancy r(100, 3, 0);
  const SE3 before = r.f.map.map.Find(KeyframeId(2))->cam_from_world;
  ASSERT_EQ(r.Cull(), Ids({2}));
  SE3 after;
  ASSERT_TRUE(r.f.map.map.CamFromWorld(KeyframeId(2), &after));
  EXPECT_LT(LocalCoordinates(before, after).norm(), 1e-12);
  EXPECT_EQ(r.f.map.map.Find(KeyframeId(3))->parent, KeyframeId(1));
}

}  // namespace
}  // namespace vpslam
