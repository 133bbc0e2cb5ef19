#include "backend/ba_window.h"

#include <gtest/gtest.h>

#include "tests/unit/synthetic_scene.h"

namespace vpslam {
namespace {

constexpr int kKeyframes = 12, kPoints = 40;

/// Keyframes side by side, all of which show the same points.
class BaWindowTest : public testing::Test {
 protected:
  BaWindowTest() : scene_(1), map_(scene_) {
    std::vector<KeyframeId> ids;
    for (int i = 0; i < kKeyframes; ++i) {
      ids.emplace_back(i);
      map_.AddKeyframe(scene_.Look(PoseAt({0.02 * i, 0, 0})));
    }
    int added = 0;
    for (int p = 0; p < static_cast<int>(scene_.points.size()) && added < kPoints; ++p) {
      bool seen = true;
      for (const auto& [id, view] : map_.views) seen = seen && view.FeatureOf(p) >= 0;
      if (!seen) continue;
      map_.AddPoint(p, ids);
      ++added;
    }
  }
  BaWindow Choose(const LocalBaOptions& options) const {
    return ChooseBaWindow(KeyframeId(kKeyframes - 1), options, map_.map);
  }

  SyntheticScene scene_;
  SyntheticMap map_;
};

TEST_F(BaWindowTest, HoldsAsManyKeyframesAsItIsTold) {
  LocalBaOptions options;
  options.max_keyframes = 3;
  options.max_fixed_keyframes = 4;
  options.plenty_points = kPoints;
  const BaWindow window = Choose(options);
  EXPECT_EQ(window.moved.size(), 3u);
  EXPECT_EQ(window.fixed.size(), 4u);
  EXPECT_TRUE(window.moved.contains(KeyframeId(kKeyframes - 1)));
  EXPECT_EQ(window.points.size(), static_cast<size_t>(kPoints));
}

TEST_F(BaWindowTest, GrowsWhereKeyframesShowLittle) {
  LocalBaOptions options;
  options.max_keyframes = 3;
  options.max_fixed_keyframes = 4;
  options.growth_power = 2;
  options.max_growth = 2;
  options.plenty_points = 1.25 * kPoints;  // 1.56 times 3, and times 4
  EXPECT_EQ(Choose(options).moved.size(), 5u);
  EXPECT_EQ(Choose(options).fixed.size(), 7u);
  options.plenty_points = 100 * kPoints;
  EXPECT_EQ(Choose(options).moved.size(), 6u);
  EXPECT_EQ(Choose(options).fixed.size(), 6u) << "all that are left";
}

TEST_F(BaWindowTest, TheOldestHoldTheGaugeWhereTooFewAreFixed) {
  LocalBaOptions options;
  options.max_keyframes = kKeyframes;
  for (const int fixed : {1, 2, 3}) {
    options.min_fixed_keyframes = fixed;
    const BaWindow window = Choose(options);
    ASSERT_EQ(window.fixed.size(), static_cast<size_t>(fixed));
    EXPECT_EQ(*window.fixed.rbegin(), KeyframeId(fixed - 1));
    EXPECT_EQ(window.moved.size(), static_cast<size_t>(kKeyframes - fixed));
  }
  options.max_keyframes = kKeyframes - 1;  // keyframe 0 sees the points and is fixed anyway
  options.min_fixed_keyframes = 2;
  options.plenty_points = kPoints;
  EXPECT_EQ(Choose(options).fixed.size(), 2u);
}

TEST_F(BaWindowTest, TheKeyframeItselfIsAlwaysMoved) {
  LocalBaOptions options;
  options.max_keyframes = kKeyframes;
  options.min_fixed_keyframes = 2 * kKeyframes;
  const BaWindow window = Choose(options);
  EXPECT_EQ(window.moved, std::set<KeyframeId>{KeyframeId(kKeyframes - 1)});
}

}  // namespace
}  // namespace vpslam
