#include "core/features/feature_grid.h"

#include <algorithm>
#include <limits>
#include <random>

#include <gtest/gtest.h>

namespace vpslam {
namespace {

constexpr Camera::Bounds kBounds{-25.0, -10.5, 670.0, 495.0};

std::vector<Keypoint> RandomKeypoints(int n, unsigned seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> x(-25.f, 670.f), y(-10.5f, 495.f);
  std::uniform_int_distribution<int> octave(0, 7);
  std::vector<Keypoint> keypoints(n);
  for (Keypoint& k : keypoints) {
    k.x_px = x(rng);
    k.y_px = y(rng);
    k.octave = octave(rng);
  }
  return keypoints;
}

std::vector<int> BruteForce(const std::vector<Keypoint>& keypoints, float x, float y, float radius,
                            OctaveRange octaves) {
  std::vector<int> found;
  for (size_t i = 0; i < keypoints.size(); ++i) {
    const Keypoint& k = keypoints[i];
    const float dx = k.x_px - x, dy = k.y_px - y;
    if (dx * dx + dy * dy < radius * radius && k.octave >= octaves.min && k.octave <= octaves.max) {
      found.push_back(static_cast<int>(i));
    }
  }
  return found;
}

TEST(FeatureGrid, FindsWhatBruteForceFinds) {
  const std::vector<Keypoint> keypoints = RandomKeypoints(1000, 1);
  const FeatureGrid grid(keypoints, kBounds);
  std::mt19937 rng(2);
  std::uniform_real_distribution<float> position(-150.f, 800.f), radius(0.5f, 120.f);
  size_t total = 0;
  for (int i = 0; i < 500; ++i) {
    const float x = position(rng), y = position(rng), r = radius(rng);
    const OctaveRange octaves = i % 2 ? OctaveRange{} : OctaveRange{i % 7, i % 7 + 2};
    std::vector<int> found = grid.FindInRadius(x, y, r, octaves);
    EXPECT_EQ(found, grid.FindInRadius(x, y, r, octaves));
    std::sort(found.begin(), found.end());
    EXPECT_EQ(found, BruteForce(keypoints, x, y, r, octaves));
    total += found.size();
  }
  EXPECT_GT(total, 1000u);
}

TEST(FeatureGrid, KeypointsOutsideTheBoundsAreFoundToo) {
  std::vector<Keypoint> keypoints(2);
  keypoints[0].x_px = -200;
  keypoints[0].y_px = 100;
  keypoints[1].x_px = 100;
  keypoints[1].y_px = 4000;
  const FeatureGrid grid(keypoints, kBounds);
  EXPECT_EQ(grid.FindInRadius(-201, 100, 5), std::vector<int>{0});
  EXPECT_EQ(grid.FindInRadius(-100, 100, 101), std::vector<int>{0});
  EXPECT_EQ(grid.FindInRadius(100, 4001, 5), std::vector<int>{1});
}

TEST(FeatureGrid, EmptyAndAbsurdQueriesFindNothing) {
  EXPECT_TRUE(FeatureGrid().FindInRadius(0, 0, 1e9f).empty());
  EXPECT_TRUE(FeatureGrid({}, kBounds).FindInRadius(0, 0, 1e9f).empty());
  const std::vector<Keypoint> keypoints = RandomKeypoints(50, 3);
  const FeatureGrid grid(keypoints, kBounds);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(grid.FindInRadius(nan, 0, 10).empty());
  EXPECT_TRUE(grid.FindInRadius(0, 0, nan).empty());
  EXPECT_TRUE(grid.FindInRadius(300, 200, 0).empty());
  EXPECT_TRUE(grid.FindInRadius(300, 200, -5).empty());
  EXPECT_TRUE(grid.FindInRadius(1e30f, -1e30f, 10).empty());
  EXPECT_TRUE(grid.FindInRadius(300, 200, 1e5f, {5, 4}).empty());
  EXPECT_EQ(grid.FindInRadius(300, 200, 1e5f).size(), 50u);
}

TEST(FeatureGrid, TinyImage) {
  std::vector<Keypoint> keypoints(1);
  keypoints[0].x_px = 2;
  keypoints[0].y_px = 3;
  const FeatureGrid grid(keypoints, {0, 0, 4, 4});
  EXPECT_EQ(grid.FindInRadius(1, 3, 2).size(), 1u);
}

}  // namespace
}  // namespace vpslam
