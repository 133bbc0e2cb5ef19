#include "frontend/relocalizer.h"

#include <gtest/gtest.h>

#include "tests/unit/frontend/tracking_scene.h"

namespace vpslam {
namespace {

bool Relocalize(const TrackingScene& s, uint64_t seed, Frame* frame,
                const std::vector<MapId>& except = {}, const RelocalizerOptions& options = {},
                const RelocalizationGate& gate = {}) {
  std::mt19937_64 rng(seed);
  TrackerOptions tracking;
  tracking.relocalizer = options;
  return Relocalizer(tracking).Find(s.context(), except, gate, rng, frame);
}

TEST(Relocalizer, FindsAFrameWithoutAnyIdeaOfWhereItIs) {
  for (const auto shape :
       {SyntheticShape::kVolume, SyntheticShape::kSlantedPlane, SyntheticShape::kFrontoParallel}) {
    TrackingScene s(1, {.shape = shape, .outlier_share = 0.2, .clutter = 150}, 5);
    Frame frame = s.NewFrame(PoseAt({0.5, 0.3, -0.4}, {0.05, 0.1, 0.05}), 0);
    ASSERT_TRUE(Relocalize(s, 1, &frame));
    // Each of more than 100 points says where the camera is to 5 x 1.5 px / 520; shifts and turns
    // look alike. Four sigma.
    EXPECT_LT(s.PositionError(frame), 4 * 3 * 5 * 1.5 / 520 / 10);
    EXPECT_GE(frame.placement.inliers, 50);
    EXPECT_EQ(frame.placement.inliers, s.NumMatched(frame));
    EXPECT_LE(s.NumWrong(frame), 0.02 * frame.placement.inliers);
  }
}

TEST(Relocalizer, AnotherPlaceIsNotFound) {
  TrackingScene s(2, {});
  SyntheticScene elsewhere(3);
  Frame frame = s.TrackedFrame(PoseAt({0, 0, 0}), 0);
  s.SetFeatures(elsewhere.Look(PoseAt({0, 0, 0})).features, &frame);
  ASSERT_GT(s.NumMatched(frame), 0);
  EXPECT_FALSE(Relocalize(s, 1, &frame));
  EXPECT_EQ(s.NumMatched(frame), 0) << "no match is left behind";
}

TEST(Relocalizer, LookingLikeItIsNotEnough) {
  // The right descriptors, all over the place.
  TrackingScene s(4, {});
  Frame frame = s.NewFrame(PoseAt({0.3, 0, 0}), 0);
  Features features = frame.seen->features;
  for (Keypoint& k : features.keypoints) {
    k.x_px = static_cast<float>(s.scene.Uniform(0, 639));
    k.y_px = static_cast<float>(s.scene.Uniform(0, 479));
  }
  s.SetFeatures(features, &frame);
  EXPECT_GT(MatchKeyframe(s.context(), KeyframeId(0), SE3(), &frame), 100);
  EXPECT_FALSE(Relocalize(s, 1, &frame));
  EXPECT_EQ(s.NumMatched(frame), 0);
}

/// Only `num` of the features that show points of the map can be recognised.
void HideAllBut(int num, const TrackingScene& s, Frame* frame) {
  int kept = 0;
  Features features = frame->seen->features;
  for (int f = 0; f < features.size(); ++f) {
    const bool known = std::any_of(s.map.truth.begin(), s.map.truth.end(), [&](const auto& entry) {
      return entry.second == s.PointOf(*frame, f);
    });
    if (known && ++kept > num) features.descriptors[f] = Descriptor{};
  }
  s.SetFeatures(features, frame);
  ASSERT_GT(kept, num);
}

TEST(Relocalizer, FewPointsAreNotEnough) {
  TrackingScene s(5, {});
  Frame frame = s.NewFrame(PoseAt({0.3, 0, 0}), 0);
  HideAllBut(45, s, &frame);
  EXPECT_FALSE(Relocalize(s, 1, &frame)) << "50 are asked for";
}

TEST(Relocalizer, APlaceThatShowsLittleOfWhatIsThereIsAnother) {
  // As where two doors look alike: enough points agree, but nearly all around them do not.
  TrackingScene s(9, {.num_points = 2400});
  Frame frame = s.NewFrame(PoseAt({0.3, 0, 0}), 0);
  HideAllBut(80, s, &frame);
  EXPECT_FALSE(Relocalize(s, 1, &frame)) << "of about 1200 points in view";
  RelocalizerOptions options;
  options.min_found_share = 0;
  EXPECT_TRUE(Relocalize(s, 1, &frame, {}, options));
}

TEST(Relocalizer, WhereItCannotHaveComeMoreIsAskedFor) {
  TrackingScene s(9, {.num_points = 2400});
  RelocalizationGate gate;
  gate.See(s.TrackedFrame(PoseAt({100, 0, 0}), 0));
  Frame frame = s.NewFrame(PoseAt({0.3, 0, 0}), 1);
  HideAllBut(200, s, &frame);
  s.SetStamp(1'000'000, &frame);
  EXPECT_TRUE(Relocalize(s, 1, &frame)) << "one in six of about 1200 points";
  EXPECT_FALSE(Relocalize(s, 1, &frame, {}, {}, gate)) << "a hundred units away a second ago";
  s.SetStamp(60'000'000, &frame);
  EXPECT_TRUE(Relocalize(s, 1, &frame, {}, {}, gate)) << "a minute ago";
}

TEST(Relocalizer, NotInAMapThatIsLeftOut) {
  TrackingScene s(6, {});
  Frame frame = s.NewFrame(PoseAt({0.3, 0, 0}), 0);
  EXPECT_FALSE(Relocalize(s, 1, &frame, {MapId(0)}));
  EXPECT_TRUE(Relocalize(s, 1, &frame, {MapId(1)}));
}

TEST(Relocalizer, TriesTheBestCandidates) {
  TrackingScene s(7, {}, 5);
  Frame frame = s.NewFrame(PoseAt({0.9, 0, 0}), 0);
  RelocalizerOptions options;
  options.max_candidates = 1;
  EXPECT_TRUE(Relocalize(s, 1, &frame, {}, options));
  options.max_candidates = 0;
  EXPECT_FALSE(Relocalize(s, 1, &frame, {}, options));
  options = {};
  options.min_matches = 10000;
  EXPECT_FALSE(Relocalize(s, 1, &frame, {}, options));
}

TEST(Relocalizer, SameInputSameResult) {
  const auto run = [] {
    TrackingScene s(8, {.outlier_share = 0.2, .clutter = 100});
    Frame frame = s.NewFrame(PoseAt({0.3, 0.2, 0}), 0);
    EXPECT_TRUE(Relocalize(s, 5, &frame));
    return frame;
  };
  const Frame a = run(), b = run();
  EXPECT_EQ(a.placement.cam_from_world.translation, b.placement.cam_from_world.translation);
  EXPECT_EQ(a.placement.points(), b.placement.points());
}

}  // namespace
}  // namespace vpslam
