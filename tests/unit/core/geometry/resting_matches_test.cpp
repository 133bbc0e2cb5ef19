#include "core/geometry/resting_matches.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "tests/unit/core/geometry/two_view_scene.h"

namespace vpslam {
namespace {

/// Adds what a bonnet shows: matches in the lowest fifth of the image that stay where they are.
void AddBonnet(int count, double noise_px, SceneMaker* maker, Scene* scene) {
  const Camera camera = SceneCamera();
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d at(maker->Uniform(0, camera.width),
                             maker->Uniform(0.8 * camera.height, camera.height));
    TwoViewMatch match;
    match.first_px = at + maker->NormalVector(noise_px).head<2>();
    match.second_px = at + maker->NormalVector(noise_px).head<2>();
    scene->matches.push_back(match);
  }
}

int Count(const std::vector<bool>& values) {
  return static_cast<int>(std::count(values.begin(), values.end(), true));
}

TEST(RestingMatches, AreThoseOfTheBonnet) {
  SceneMaker maker(1);
  SceneOptions options;
  int found = 0, seldom_wrong = 0;
  for (int trial = 0; trial < 50; ++trial) {
    for (const double noise_px : {0.2, 0.7}) {  // the given sigma is 1
      Scene scene = maker.Make(options);
      const auto world = scene.matches.size();
      AddBonnet(50, noise_px, &maker, &scene);
      const auto resting = RestingMatches(scene.matches, {});
      ASSERT_EQ(resting.size(), scene.matches.size());
      found += Count({resting.begin() + static_cast<long>(world), resting.end()}) >= 49;
      // Few points of a scene in motion happen to stay: those whose turn undoes their shift.
      seldom_wrong += Count({resting.begin(), resting.begin() + static_cast<long>(world)});
    }
  }
  EXPECT_GE(found, 90) << "of 100; a random motion may be too small to tell";
  EXPECT_LT(seldom_wrong, 0.02 * 100 * options.num_matches);
}

TEST(RestingMatches, WithoutThemAMotionIsFoundAsIfTheyWereNotThere) {
  SceneMaker maker(2);
  SceneOptions options;
  options.noise_px = 0.5;
  options.parallax_rad = Radians(2.5);
  options.rotation_sigma_rad = Radians(0.7);
  int with_bonnet = 0, taken_out = 0, without = 0;
  constexpr int kTrials = 60;
  for (int trial = 0; trial < kTrials; ++trial) {
    Scene scene = maker.Make(options);
    const auto is_right = [&](std::vector<TwoViewMatch> matches) {
      std::mt19937_64 rng(trial);
      const auto result = EstimateTwoView(SceneCamera(), matches, {}, rng);
      return result.status == TwoViewStatus::kOk &&
             DirectionError_rad(result.candidates[0].second_from_first, scene.second_from_first) <
                 Radians(10);
    };
    without += is_right(scene.matches);
    AddBonnet(100, 0.2, &maker, &scene);
    with_bonnet += is_right(scene.matches);
    const auto resting = RestingMatches(scene.matches, {});
    std::vector<TwoViewMatch> moving;
    for (size_t i = 0; i < resting.size(); ++i) {
      if (!resting[i]) moving.push_back(scene.matches[i]);
    }
    taken_out += is_right(moving);
  }
  EXPECT_GE(taken_out, without - kTrials / 20);
  EXPECT_GT(taken_out, with_bonnet + kTrials / 10);
  RecordProperty("with_bonnet", with_bonnet);
  RecordProperty("without", without);
}

TEST(RestingMatches, WhatCountsIsTheImageAndNotTheCorners) {
  SceneMaker maker(6);
  int found = 0;
  for (int trial = 0; trial < 20; ++trial) {
    Scene scene = maker.Make({});
    AddBonnet(600, 0.3, &maker, &scene);  // three times as many as the plain world has
    found += Count(RestingMatches(scene.matches, {})) >= 590;
  }
  EXPECT_GE(found, 18);
}

TEST(RestingMatches, ThereAreNoneInASceneThatIsAllWorld) {
  SceneMaker maker(3);
  for (int trial = 0; trial < 100; ++trial) {
    SceneOptions options;
    options.shape = static_cast<SceneShape>(trial % 3);
    options.forward = trial % 2 == 0;
    options.parallax_rad = Radians(maker.Uniform(0, 4));
    options.rotation_sigma_rad = Radians(maker.Uniform(0, 3));
    options.outlier_share = 0.2;
    EXPECT_EQ(Count(RestingMatches(maker.Make(options).matches, {})), 0) << trial;
  }
}

TEST(RestingMatches, AFixatedPointIsNone) {
  // The camera goes round a point 5 away, between 2 and 8: that one stays, nearer and farther ones
  // go either way.
  SceneMaker maker(4);
  const Camera camera = SceneCamera();
  const double angle_rad = Radians(4);
  const SE3 second_from_first(
      ExpSo3(Eigen::Vector3d(0, angle_rad, 0)),
      Eigen::Vector3d(-5 * std::sin(angle_rad), 0, 5 * (1 - std::cos(angle_rad))));
  std::vector<TwoViewMatch> matches;
  while (matches.size() < 300) {
    const Eigen::Vector2d first(maker.Uniform(0, camera.width), maker.Uniform(0, camera.height));
    const Eigen::Vector3d point = maker.Uniform(2, 8) * camera.Unproject(first);
    TwoViewMatch match;
    match.first_px = first + maker.NormalVector(0.3).head<2>();
    match.second_px = camera.Project(second_from_first * point) + maker.NormalVector(0.3).head<2>();
    matches.push_back(match);
  }
  EXPECT_EQ(Count(RestingMatches(matches, {})), 0);
}

TEST(RestingMatches, ACameraAtRestSeesAWorldAtRest) {
  SceneMaker maker(5);
  const Camera camera = SceneCamera();
  std::vector<TwoViewMatch> matches;
  for (int i = 0; i < 500; ++i) {
    TwoViewMatch match;
    match.first_px = {maker.Uniform(0, camera.width), maker.Uniform(0, camera.height)};
    match.second_px = match.first_px + maker.NormalVector(0.3).head<2>();
    // Somebody walks by, and shows more corners than all else.
    if (i % 3 > 0) match.first_px.x() *= 0.3;
    if (i % 3 > 0) match.second_px = match.first_px + Eigen::Vector2d(30, 0);
    matches.push_back(match);
  }
  EXPECT_EQ(Count(RestingMatches(matches, {})), 0);
  EXPECT_TRUE(RestingMatches({}, {}).empty());
}

TEST(RestingMatchesOptions, AreValidated) {
  EXPECT_EQ(RestingMatchesOptions().Validate(), std::nullopt);
  RestingMatchesOptions options;
  options.min_moving_sigmas = 1;
  EXPECT_NE(options.Validate(), std::nullopt);
  options = {};
  options.min_moving_share = 0;
  EXPECT_NE(options.Validate(), std::nullopt);
}

}  // namespace
}  // namespace vpslam
