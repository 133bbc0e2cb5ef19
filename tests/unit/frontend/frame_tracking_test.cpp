#include "frontend/frame_tracking.h"

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "tests/unit/frontend/tracking_scene.h"

namespace vpslam {
namespace {

TEST(MatchLastFrame, FindsThePointsAgain) {
  TrackingScene s(1, {.outlier_share = 0.05, .clutter = 100});
  const Frame last = s.TrackedFrame(PoseAt({0.3, 0, 0}), 0);
  Frame frame = s.NewFrame(PoseAt({0.33, 0.02, 0.01}, {0.004, 0.003, 0}), 1);
  const int matches =
      MatchLastFrame(s.context(), last, last.placement.cam_from_world, 15, {}, &frame);
  EXPECT_EQ(matches, s.NumMatched(frame));
  EXPECT_GT(matches, 0.85 * s.NumMatched(last));
  EXPECT_LT(s.NumWrong(frame), 0.03 * matches);
}

TEST(MatchLastFrame, TheWindowLimits) {
  TrackingScene s(2, {.max_octave = 0});  // octaves 0 to 3 are 1 to 1.7 windows wide
  const Frame last = s.TrackedFrame(PoseAt({0.3, 0, 0}), 0);
  Frame frame = s.NewFrame(PoseAt({0.3, 0, 0}, {0, 0.06, 0}), 1);  // 31 px
  EXPECT_EQ(MatchLastFrame(s.context(), last, last.placement.cam_from_world, 15, {}, &frame), 0);
  EXPECT_GT(MatchLastFrame(s.context(), last, last.placement.cam_from_world, 45, {}, &frame),
            0.8 * s.NumMatched(last));
}

TEST(MatchLastFrame, PointsThatAreGoneAreNotLookedForAndFusedOnesAre) {
  TrackingScene s(3, {});
  const Frame last = s.TrackedFrame(PoseAt({0.3, 0, 0}), 0);
  std::vector<PointId> ids;
  for (const PointId id : last.placement.points()) {
    if (id.IsValid()) ids.push_back(id);
  }
  ASSERT_GT(ids.size(), 100u);
  // The first is erased; the second is the duplicate of a point that comes with the delta.
  OwnedMap& map = s.map.map;
  map.Erase(ids[0]);
  const int p = s.map.truth.at(ids[1]);
  const PointId better = s.map.AddPoint(p, {KeyframeId(0), KeyframeId(1)});
  map.Fuse(ids[1], better);
  Frame frame = s.NewFrame(PoseAt({0.31, 0, 0}), 1);
  MatchLastFrame(s.context(), last, last.placement.cam_from_world, 15, {}, &frame);
  const auto count = [&](PointId id) {
    return std::count(frame.placement.points().begin(), frame.placement.points().end(), id);
  };
  EXPECT_EQ(count(ids[0]), 0);
  EXPECT_EQ(count(ids[1]), 0);
  EXPECT_EQ(count(better), 1);
}

TEST(MatchLastFrame, APointIsMatchedOnce) {
  // Two points of the last frame, on two octaves of one corner, were fused since.
  TrackingScene s(4, {.noise_sigmas = 0});
  Frame last = s.TrackedFrame(PoseAt({0.3, 0, 0}), 0);
  Frame frame = s.NewFrame(PoseAt({0.3, 0, 0}), 1);
  Features of_last = last.seen->features, of_frame = frame.seen->features;
  const auto add_twin = [](int feature, Features* features) {
    Keypoint twin = features->keypoints[feature];
    twin.octave += 1;
    features->keypoints.push_back(twin);
    features->descriptors.push_back(features->descriptors[feature]);
  };
  std::vector<PointId> doubled;
  const int n = of_last.size();
  for (int i = 0; i < n && doubled.size() < 20; ++i) {
    const PointId id = last.placement.points()[i];
    if (!id.IsValid() || of_last.keypoints[i].octave == 7) continue;
    const int j = s.FeatureOf(frame, s.PointOf(last, i));
    if (j < 0) continue;
    add_twin(i, &of_last);
    add_twin(j, &of_frame);
    doubled.push_back(id);
  }
  s.SetFeatures(of_frame, &frame);
  s.SetFeatures(of_last, &last);
  for (size_t k = 0; k < doubled.size(); ++k) {
    last.placement.Match(n + static_cast<int>(k), s.Point(doubled[k]));
  }
  MatchLastFrame(s.context(), last, last.placement.cam_from_world, 15, {}, &frame);
  std::map<PointId, int> count;
  for (const PointId id : frame.placement.points()) {
    if (id.IsValid()) ++count[id];
  }
  for (const auto& [id, times] : count) EXPECT_EQ(times, 1);
}

TEST(MatchLastFrame, WhatTurnedOtherwiseIsDropped) {
  TrackingScene s(5, {});
  const Frame last = s.TrackedFrame(PoseAt({0.3, 0, 0}), 0);
  Frame frame = s.NewFrame(PoseAt({0.3, 0, 0}), 1);
  const int all = MatchLastFrame(s.context(), last, last.placement.cam_from_world, 15, {}, &frame);
  Features turned = frame.seen->features;
  for (int i = 0; i < 60; ++i) {
    turned.keypoints[i].angle_rad += 1.0f + 0.07f * static_cast<float>(i);
  }
  s.SetFeatures(turned, &frame);
  const int rest = MatchLastFrame(s.context(), last, last.placement.cam_from_world, 15, {}, &frame);
  EXPECT_LT(rest, all - 15);
  for (int i = 0; i < 60; i += 1) {
    EXPECT_FALSE(i > 20 && i < 40 && frame.placement.points()[i].IsValid());
  }
}

TEST(MatchKeyframe, NeedsNoPose) {
  TrackingScene s(6, {.clutter = 200});
  Frame frame = s.NewFrame(PoseAt({0.5, -0.2, 0.2}, {0.05, 0.1, 0}), 1);
  const SE3 far_away = PoseAt({100, 100, 100});
  const int matches = MatchKeyframe(s.context(), KeyframeId(0), far_away, &frame);
  EXPECT_EQ(matches, s.NumMatched(frame));
  EXPECT_GT(matches, 100);
  EXPECT_EQ(s.NumWrong(frame), 0);
  EXPECT_EQ(MatchKeyframe(s.context(), KeyframeId(99), far_away, &frame), 0);
  EXPECT_EQ(s.NumMatched(frame), 0);
}

TEST(OptimizeFrame, PoseWithinItsCovarianceAndOutliersGone) {
  double sum = 0;
  constexpr int kTrials = 40;
  for (int i = 0; i < kTrials; ++i) {
    TrackingScene s(100 + i, {.num_points = 300});
    Frame frame = s.TrackedFrame(PoseAt({0.3, 0, 0}), 0);
    const SE3 truth = frame.placement.cam_from_world;
    // One in five is taken for another point.
    std::vector<int> wrong;
    std::vector<int> matched;
    const std::vector<PointId> points = frame.placement.points();
    for (int f = 0; f < static_cast<int>(points.size()); ++f) {
      if (points[f].IsValid()) matched.push_back(f);
    }
    for (size_t k = 0; k + 5 < matched.size(); k += 5) {
      frame.placement.Match(matched[k], s.Point(points[matched[k + 1]]));
      frame.placement.Match(matched[k + 1], s.Point(points[matched[k]]));
      wrong.insert(wrong.end(), {matched[k], matched[k + 1]});
    }
    frame.placement.cam_from_world = s.scene.Disturbed(truth, 0.03, 0.01);
    const int inliers = OptimizeFrame(s.context(), {}, &frame);
    EXPECT_EQ(inliers, frame.placement.inliers);
    EXPECT_EQ(inliers, s.NumMatched(frame));
    EXPECT_EQ(frame.placement.num_matches, static_cast<int>(matched.size()));
    int left = 0;
    for (const int f : wrong) left += frame.placement.points()[f].IsValid();
    EXPECT_LE(left, 2);
    const Vector6d e = LocalCoordinates(frame.placement.cam_from_world, truth);
    sum += e.dot(frame.placement.covariance.ldlt().solve(e));
  }
  // Chi-square with six degrees of freedom; the mean of 40 has a standard deviation of 0.55.
  EXPECT_NEAR(sum / kTrials, 6, 2);
}

TEST(OptimizeFrame, PointsThatAreGoneAreNoMatches) {
  TrackingScene s(7, {});
  Frame frame = s.TrackedFrame(PoseAt({0.3, 0, 0}), 0);
  const int before = s.NumMatched(frame);
  int erased = 0;
  for (int f = 0; f < frame.seen->num_features() && erased < 30; ++f) {
    if (!frame.placement.points()[f].IsValid()) continue;
    s.map.map.Erase(frame.placement.points()[f]);
    ++erased;
  }
  OptimizeFrame(s.context(), {}, &frame);
  EXPECT_EQ(frame.placement.num_matches, before - erased);
  for (const PointId id : frame.placement.points())
    EXPECT_TRUE(!id.IsValid() || s.map.map.Find(id));
}

}  // namespace
}  // namespace vpslam
