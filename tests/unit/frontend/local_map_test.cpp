// The local map, and when a frame becomes a keyframe.
#include "frontend/local_map.h"

#include <gtest/gtest.h>

#include "frontend/keyframe_policy.h"
#include "tests/unit/frontend/tracking_scene.h"

namespace vpslam {
namespace {

TEST(CollectLocalMap, TheReferenceSharesMost) {
  TrackingScene s(1, {}, 5);
  const Frame frame = s.TrackedFrame(PoseAt({1.0, 0, 0}), 0);
  const LocalMap local = CollectLocalMap(s.map.map, frame, {});
  std::map<KeyframeId, int> votes;
  for (const PointId id : frame.placement.points()) {
    if (!id.IsValid()) continue;
    for (const Observation& o : s.map.map.Find(id)->observations) ++votes[o.keyframe];
  }
  for (const auto& [k, count] : votes) EXPECT_LE(count, votes.at(local.reference));
  EXPECT_EQ(local.keyframes.size(), 5u);
  EXPECT_EQ(local.keyframes.front(), local.reference);
  EXPECT_EQ(std::set<KeyframeId>(local.keyframes.begin(), local.keyframes.end()).size(), 5u);
  EXPECT_TRUE(std::is_sorted(local.points.begin(), local.points.end()));
  EXPECT_EQ(std::adjacent_find(local.points.begin(), local.points.end()), local.points.end());
  EXPECT_EQ(local.points.size(), s.map.truth.size());
}

TEST(CollectLocalMap, NeighboursBringWhatComesIntoView) {
  // A long row: the frame sees points of the first keyframes, and these share some with the next.
  TrackingScene s(2, {.num_points = 3000, .length = 34}, 16, 1.6);
  const Frame frame = s.TrackedFrame(PoseAt({0, 0, 0}), 0);
  const auto keyframes = [&](const LocalMapOptions& options) {
    return CollectLocalMap(s.map.map, frame, options).keyframes;
  };
  const auto alone = keyframes({.neighbours = 0}), with = keyframes({.neighbours = 10});
  EXPECT_GT(with.size(), alone.size());
  EXPECT_LT(with.size(), 16u) << "neighbours of neighbours are not asked";
  const auto few = keyframes({.max_keyframes = 3});
  ASSERT_EQ(few.size(), 3u);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(few[i], with[i]);
}

TEST(CollectLocalMap, WithoutMatchesItIsEmpty) {
  TrackingScene s(3, {});
  const LocalMap local = CollectLocalMap(s.map.map, s.NewFrame(PoseAt({0, 0, 0}), 0), {});
  EXPECT_FALSE(local.reference.IsValid());
  EXPECT_TRUE(local.keyframes.empty());
  EXPECT_TRUE(local.points.empty());
}

TEST(CollectLocalMap, CulledKeyframesAndErasedPointsAreNoPartOfIt) {
  TrackingScene s(4, {}, 5);
  const Frame frame = s.TrackedFrame(PoseAt({0.6, 0, 0}), 0);
  s.map.map.Cull(KeyframeId(2));
  const PointId erased =
      *std::find_if(frame.placement.points().begin(), frame.placement.points().end(),
                    [](PointId id) { return id.IsValid(); });
  if (s.map.map.Find(erased)) s.map.map.Erase(erased);
  const LocalMap local = CollectLocalMap(s.map.map, frame, {});
  EXPECT_EQ(local.keyframes.size(), 4u);
  for (const KeyframeId k : local.keyframes) EXPECT_NE(k, KeyframeId(2));
  for (const PointId id : local.points) EXPECT_TRUE(s.map.map.Find(id));
}

struct LocalSearch {
  explicit LocalSearch(uint64_t seed, const SyntheticOptions& options = {})
      : s(seed, options, 5), frame(s.TrackedFrame(PoseAt({0.6, 0.1, 0}), 0)) {
    local = CollectLocalMap(s.map.map, frame, {});
    all = frame.placement.points();
    // Of what there is, one in four is matched already.
    for (int i = 0; i < frame.seen->num_features(); ++i) {
      if (i % 4) frame.placement.UnmatchPoint(i);
    }
  }
  int Match(double radius_factor = 1) {
    visible.clear();
    return MatchLocalMap(s.context(), local, {}, radius_factor, &frame, &visible);
  }
  TrackingScene s;
  Frame frame;
  LocalMap local;
  std::vector<PointId> all, visible;
};

TEST(MatchLocalMap, FindsTheRest) {
  LocalSearch search(5, {.outlier_share = 0.05, .clutter = 100});
  const int before = TrackingScene::NumMatched(search.frame);
  const auto points = search.frame.placement.points();
  const int found = search.Match();
  EXPECT_EQ(TrackingScene::NumMatched(search.frame), before + found);
  const auto there =
      std::count_if(search.all.begin(), search.all.end(), [](PointId id) { return id.IsValid(); });
  EXPECT_GT(before + found, 0.85 * static_cast<double>(there));
  EXPECT_LT(search.s.NumWrong(search.frame), 0.02 * found);
  std::set<PointId> once;
  for (size_t i = 0; i < points.size(); ++i) {
    if (points[i].IsValid()) {
      EXPECT_EQ(search.frame.placement.points()[i], points[i]);
    }
    const PointId id = search.frame.placement.points()[i];
    if (id.IsValid()) {
      EXPECT_TRUE(once.insert(id).second);
    }
  }
}

TEST(MatchLocalMap, VisibleIsWhatShouldBeSeen) {
  LocalSearch search(6, {.noise_sigmas = 0});
  search.Match();
  std::set<PointId> visible(search.visible.begin(), search.visible.end());
  EXPECT_EQ(visible.size(), search.visible.size()) << "each once";
  for (const PointId id : search.frame.placement.points()) {
    if (id.IsValid()) {
      EXPECT_TRUE(visible.contains(id));
    }
  }
  for (const PointId id : visible) {
    const Eigen::Vector3d x =
        search.frame.placement.cam_from_world * search.s.map.map.Find(id)->position;
    EXPECT_GT(x.z(), 0);
    EXPECT_TRUE(search.s.scene.bounds.Contains(search.s.scene.camera.Project(x)));
  }
  // Without noise, what is visible is found.
  EXPECT_GT(TrackingScene::NumMatched(search.frame), 0.9 * static_cast<double>(visible.size()));
}

TEST(MatchLocalMap, LooksAsFarAroundAsToldTo) {
  const auto found = [](double off_px, double radius_factor) {
    LocalSearch search(7, {.max_octave = 0, .noise_sigmas = 0});
    const int before = TrackingScene::NumMatched(search.frame);
    search.frame.placement.cam_from_world =
        SE3(ExpSo3({0, off_px / 520, 0}), {0, 0, 0}) * search.frame.placement.cam_from_world;
    return search.Match(radius_factor) / static_cast<double>(before);
  };
  EXPECT_GT(found(2, 1), 2);
  EXPECT_LT(found(9, 1), 0.05);  // 4 px x 1.2^3 at most, for the nearest
  EXPECT_GT(found(9, 4), 2);
}

TEST(IsKeyframe, CountsFramesAndPoints) {
  TrackingScene s(8, {}, 4);
  const KeyframeId reference(1);
  int sure = 0, two = 0;
  for (const PointId id : s.map.map.Find(reference)->points) {
    const MapPoint* point = s.map.map.Find(id);
    sure += point && point->observations.size() >= 3;
    two += point != nullptr;
  }
  ASSERT_GT(sure, 100);
  ASSERT_GT(two, sure);
  const KeyframePolicyOptions options{.max_tracked_ratio = 0.9, .min_frames = 3, .min_inliers = 15};
  Frame frame;
  const auto is_keyframe = [&](int inliers, int frames_since) {
    frame.placement.inliers = inliers;
    return IsKeyframe(frame, reference, EarlierKeyframes{frames_since, 0}, s.map.map, options);
  };
  const int limit = static_cast<int>(std::ceil(0.9 * sure));
  EXPECT_TRUE(is_keyframe(limit - 1, 3));
  EXPECT_FALSE(is_keyframe(limit, 3));
  EXPECT_FALSE(is_keyframe(limit - 1, 2)) << "too soon";
  EXPECT_TRUE(is_keyframe(15, 3));
  EXPECT_FALSE(is_keyframe(14, 3)) << "a frame that sees nothing is no help";
  EXPECT_FALSE(IsKeyframe(frame, KeyframeId(99), {10, 0}, s.map.map, options))
      << "unknown reference";
}

TEST(IsKeyframe, KeyframesAreThinnedOutWhileTheBackendIsBusy) {
  TrackingScene s(8, {}, 4);
  const KeyframeId reference(1);
  int sure = 0;
  for (const PointId id : s.map.map.Find(reference)->points) {
    const MapPoint* point = s.map.map.Find(id);
    sure += point && point->observations.size() >= 3;
  }
  const KeyframePolicyOptions options{.max_tracked_ratio = 0.9,
                                      .max_unanswered = 2,
                                      .max_unanswered_when_weak = 3,
                                      .weak_tracked_ratio = 0.5,
                                      .weak_support = 0};
  Frame frame;
  const auto is_keyframe = [&](double share, int unanswered) {
    frame.placement.inliers = static_cast<int>(share * sure);
    return IsKeyframe(frame, reference, {1, unanswered}, s.map.map, options);
  };
  EXPECT_TRUE(is_keyframe(0.8, 0));
  EXPECT_TRUE(is_keyframe(0.8, 1));
  EXPECT_FALSE(is_keyframe(0.8, 2));
  EXPECT_TRUE(is_keyframe(0.4, 2)) << "tracking is about to be lost";
  EXPECT_FALSE(is_keyframe(0.4, 3)) << "the backlog is bounded in any case";
  EXPECT_FALSE(is_keyframe(0.95, 0));
}

TEST(IsKeyframe, FewLandmarksAreWeakWhateverTheReferenceHas) {
  TrackingScene s(8, {}, 4);
  const KeyframeId reference(1);
  KeyframePolicyOptions options{.max_tracked_ratio = 10,
                                .max_unanswered = 1,
                                .max_unanswered_when_weak = 2,
                                .weak_tracked_ratio = 0,
                                .weak_support = 60};
  Frame frame;
  frame.placement.inliers = 60;
  EXPECT_FALSE(IsKeyframe(frame, reference, {1, 1}, s.map.map, options));
  frame.placement.inliers = 59;
  EXPECT_TRUE(IsKeyframe(frame, reference, {1, 1}, s.map.map, options));
  EXPECT_FALSE(IsKeyframe(frame, reference, {1, 2}, s.map.map, options));
}

TEST(IsKeyframe, AYoungMapHasNoPointSeenThrice) {
  TrackingScene s(9, {}, 2);
  int two = 0;
  for (const PointId id : s.map.map.Find(KeyframeId(0))->points) two += id.IsValid();
  const KeyframePolicyOptions options{.max_tracked_ratio = 0.9};
  Frame frame;
  frame.placement.inliers = static_cast<int>(0.9 * two) - 1;
  EXPECT_TRUE(IsKeyframe(frame, KeyframeId(0), {1, 0}, s.map.map, options));
  frame.placement.inliers += 2;
  EXPECT_FALSE(IsKeyframe(frame, KeyframeId(0), {1, 0}, s.map.map, options));
}

}  // namespace
}  // namespace vpslam
