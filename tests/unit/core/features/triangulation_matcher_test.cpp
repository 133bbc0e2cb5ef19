#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "core/features/matcher.h"
#include "tests/unit/core/features/test_images.h"

namespace vpslam {
namespace {

/// Points seen by two cameras; feature i of one image is feature i of the other.
struct Scene {
  Camera camera = PinholeCamera();
  ScalePyramid scales{8, 1.2};
  SE3 second_from_first;
  Features first, second;
  std::vector<int32_t> all;
};

Scene MakeScene(const SE3& second_from_first, double noise_px, unsigned seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> pixel_x(20, 620), pixel_y(20, 460), depth(2, 8);
  std::normal_distribution<double> noise(0, noise_px);
  Scene scene;
  scene.second_from_first = second_from_first;
  while (scene.first.size() < 500) {
    const Eigen::Vector2d a(pixel_x(rng), pixel_y(rng));
    const Eigen::Vector3d x = second_from_first * (scene.camera.Unproject(a) * depth(rng));
    if (x.z() < 0.5) continue;
    const Eigen::Vector2d b = scene.camera.Project(x);
    if (!scene.camera.UndistortedBounds().Contains(b)) continue;
    const int octave = static_cast<int>(rng() % 8);
    const double s = scene.scales.scale(octave);
    const auto add = [&](const Eigen::Vector2d& p, Features* features) {
      Keypoint k;
      k.x_px = static_cast<float>(p.x());
      k.y_px = static_cast<float>(p.y());
      k.octave = octave;
      k.angle_rad = 1.0f;
      features->keypoints.push_back(k);
    };
    add(a, &scene.first);
    add(b + s * Eigen::Vector2d(noise(rng), noise(rng)), &scene.second);
    Descriptor d{rng(), rng(), rng(), rng()};
    scene.first.descriptors.push_back(d);
    d[rng() % 4] ^= uint64_t{0xFFFFF} << (rng() % 40);  // 20 bits
    scene.second.descriptors.push_back(d);
  }
  scene.all.resize(500);
  std::iota(scene.all.begin(), scene.all.end(), 0);
  return scene;
}

SE3 Sideways() { return SE3(ExpSo3({0.02, -0.05, 0.01}), {-0.4, 0.03, 0.05}); }
SE3 Forward() { return SE3(ExpSo3({0.01, 0.01, 0.0}), {0.0, 0.0, -0.8}); }

std::vector<Match> MatchAll(const Scene& s, const TriangulationMatchOptions& options = {}) {
  return MatchForTriangulation(s.first, s.all, s.second, s.all, s.second_from_first, s.camera,
                               s.scales, options);
}

TEST(MatchForTriangulation, FindsTheTruth) {
  const Scene s = MakeScene(Sideways(), 0.3, 1);
  const std::vector<Match> matches = MatchAll(s);
  EXPECT_GT(matches.size(), 495u);
  for (const Match& m : matches) EXPECT_EQ(m.first, m.second);
}

TEST(MatchForTriangulation, ForwardMotionLeavesOutTheEpipole) {
  const Scene s = MakeScene(Forward(), 0.0, 2);
  const Eigen::Vector2d epipole = s.camera.Project(s.second_from_first.translation);
  const std::vector<Match> matches = MatchAll(s, {.min_epipole_px = 30});
  std::set<int> matched;
  for (const Match& m : matches) {
    EXPECT_EQ(m.first, m.second);
    matched.insert(m.second);
  }
  int near = 0;
  for (int i = 0; i < 500; ++i) {
    const Keypoint& k = s.second.keypoints[i];
    const bool is_near = (k.Position() - epipole).norm() < 30 * s.scales.scale(k.octave);
    EXPECT_EQ(matched.count(i), is_near ? 0u : 1u);
    near += is_near;
  }
  EXPECT_GT(near, 5);
}

TEST(MatchForTriangulation, GateGrowsWithTheOctave) {
  Scene s = MakeScene(SE3(Eigen::Quaterniond::Identity(), {-0.5, 0, 0}), 0.0, 3);
  // The epipolar lines are rows; 1.96 sigma is the gate.
  for (Keypoint& k : s.second.keypoints) {
    k.y_px += static_cast<float>(1.9 * s.scales.scale(k.octave));
  }
  EXPECT_EQ(MatchAll(s).size(), 500u);
  for (Keypoint& k : s.second.keypoints) {
    k.y_px += static_cast<float>(0.12 * s.scales.scale(k.octave));
  }
  EXPECT_EQ(MatchAll(s).size(), 0u);
}

TEST(MatchForTriangulation, OnlyWhatIsFree) {
  const Scene s = MakeScene(Sideways(), 0.0, 4);
  std::vector<int32_t> first_free, second_free;
  for (int i = 0; i < 500; ++i) {
    if (i % 2) first_free.push_back(i);
    if (i % 3) second_free.push_back(i);
  }
  const std::vector<Match> matches = MatchForTriangulation(
      s.first, first_free, s.second, second_free, s.second_from_first, s.camera, s.scales);
  EXPECT_GT(matches.size(), 160u);
  for (const Match& m : matches) {
    EXPECT_EQ(m.first, m.second);
    EXPECT_TRUE(m.first % 2 && m.first % 3);
  }
}

TEST(MatchForTriangulation, LookAlikesOnTheLineAreNoMatchAndElsewhereDoNotHarm) {
  Scene s = MakeScene(SE3(Eigen::Quaterniond::Identity(), {-0.5, 0, 0}), 0.0, 5);
  for (Keypoint& k : s.second.keypoints) k.octave = 0;
  const auto duplicate = [&](int i, float dx, float dy) {
    s.second.keypoints.push_back(s.second.keypoints[i]);
    s.second.keypoints.back().x_px += dx;
    s.second.keypoints.back().y_px += dy;
    s.second.descriptors.push_back(s.second.descriptors[i]);
    s.all.push_back(static_cast<int32_t>(s.all.size()));
  };
  duplicate(7, -40, 0);
  duplicate(8, -40, 15);
  std::vector<int32_t> first_all(500);
  std::iota(first_all.begin(), first_all.end(), 0);
  std::map<int, int> second_of;
  for (const Match& m : MatchForTriangulation(s.first, first_all, s.second, s.all,
                                              s.second_from_first, s.camera, s.scales)) {
    second_of[m.first] = m.second;
  }
  EXPECT_EQ(second_of.count(7), 0u);
  EXPECT_EQ(second_of.at(8), 8);
}

TEST(MatchForTriangulation, WhatImpliesAnImpossibleDepthIsNoRival) {
  Scene s = MakeScene(SE3(Eigen::Quaterniond::Identity(), {-0.5, 0, 0}), 0.0, 5);
  for (Keypoint& k : s.second.keypoints) k.octave = 0;
  // The camera moved to the right, so everything moves to the left: what did not is behind it.
  s.second.keypoints.push_back(s.second.keypoints[7]);
  s.second.keypoints.back().x_px = s.first.keypoints[7].x_px + 20;
  s.second.descriptors.push_back(s.second.descriptors[7]);
  s.all.push_back(static_cast<int32_t>(s.all.size()));
  std::vector<int32_t> first_all(500);
  std::iota(first_all.begin(), first_all.end(), 0);
  const auto matches = MatchForTriangulation(s.first, first_all, s.second, s.all,
                                             s.second_from_first, s.camera, s.scales);
  EXPECT_TRUE(std::find(matches.begin(), matches.end(), Match{7, 7}) != matches.end());
}

TEST(MatchForTriangulation, OneToOne) {
  Scene s = MakeScene(SE3(Eigen::Quaterniond::Identity(), {-0.5, 0, 0}), 0.0, 6);
  // Two first features on one line that look like the same second one: the nearer gets it.
  s.first.keypoints[1].x_px = s.first.keypoints[0].x_px + 5;
  s.first.keypoints[1].y_px = s.first.keypoints[0].y_px;
  s.first.descriptors[1] = s.second.descriptors[0];
  const std::vector<Match> matches = MatchAll(s);
  std::set<int> seconds;
  for (const Match& m : matches) {
    EXPECT_TRUE(seconds.insert(m.second).second);
    EXPECT_NE(m.first, 0);
  }
  EXPECT_TRUE(std::find(matches.begin(), matches.end(), Match{1, 0}) != matches.end());
}

TEST(MatchForTriangulation, TurnedOtherwiseIsDropped) {
  Scene s = MakeScene(Sideways(), 0.0, 7);
  for (int i = 0; i < 30; ++i)
    s.second.keypoints[i].angle_rad += 1.0f + 0.13f * static_cast<float>(i);
  const std::vector<Match> matches = MatchAll(s);
  EXPECT_GE(matches.size(), 468u);
  EXPECT_LE(matches.size(), 474u);
}

TEST(MatchForTriangulation, NothingToDo) {
  Scene s = MakeScene(Sideways(), 0.0, 8);
  EXPECT_TRUE(
      MatchForTriangulation(s.first, {}, s.second, s.all, s.second_from_first, s.camera, s.scales)
          .empty());
  EXPECT_TRUE(
      MatchForTriangulation(s.first, s.all, s.second, {}, s.second_from_first, s.camera, s.scales)
          .empty());
  s.second_from_first.translation.setZero();
  EXPECT_TRUE(MatchAll(s).empty());
}

}  // namespace
}  // namespace vpslam
