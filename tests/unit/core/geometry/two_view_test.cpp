#include "core/geometry/two_view.h"

#include <algorithm>
#include <limits>
#include <map>

#include <gtest/gtest.h>

#include "tests/unit/core/geometry/two_view_scene.h"

namespace vpslam {
namespace {

TwoViewResult Estimate(const Scene& scene, uint64_t seed = 1, const TwoViewOptions& options = {}) {
  std::mt19937_64 rng(seed);
  return EstimateTwoView(SceneCamera(), scene.matches, options, rng);
}

struct Statistics {
  std::map<TwoViewStatus, int> count;
  std::vector<double> rotation_rad, direction_rad;  ///< of the candidate next to the truth
  int truth_missing = 0;  ///< candidates were given, and the truth was not among them

  int Accepted() { return count[TwoViewStatus::kOk] + count[TwoViewStatus::kAmbiguous]; }
  static double Median(std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v.empty() ? 10.0 : v[v.size() / 2];
  }
};

Statistics RunTrials(const SceneOptions& options, int trials, uint64_t seed) {
  SceneMaker maker(seed);
  Statistics statistics;
  for (int trial = 0; trial < trials; ++trial) {
    const Scene scene = maker.Make(options);
    const TwoViewResult result = Estimate(scene, trial);
    ++statistics.count[result.status];
    if (result.candidates.empty()) continue;
    double rotation_rad = 10, direction_rad = 10;
    for (const TwoViewCandidate& c : result.candidates) {
      EXPECT_NEAR(c.second_from_first.translation.norm(), 1, 1e-9);
      const double error_rad = DirectionError_rad(c.second_from_first, scene.second_from_first);
      if (error_rad > direction_rad) continue;
      direction_rad = error_rad;
      rotation_rad = RotationError_rad(c.second_from_first, scene.second_from_first);
    }
    statistics.truth_missing += direction_rad > Radians(25);
    statistics.rotation_rad.push_back(rotation_rad);
    statistics.direction_rad.push_back(direction_rad);
  }
  return statistics;
}

TEST(TwoView, IsNearlyExactWithLittleNoise) {
  SceneMaker maker(1);
  SceneOptions options;
  options.noise_px = 1e-3;
  for (int trial = 0; trial < 50; ++trial) {
    const Scene scene = maker.Make(options);
    const TwoViewResult result = Estimate(scene, trial);
    ASSERT_EQ(result.status, TwoViewStatus::kOk);
    const TwoViewCandidate& c = result.candidates[0];
    EXPECT_LT(RotationError_rad(c.second_from_first, scene.second_from_first), Radians(0.005));
    EXPECT_LT(DirectionError_rad(c.second_from_first, scene.second_from_first), Radians(0.05));
    EXPECT_GE(c.num_points, 180);
    const double baseline = scene.second_from_first.translation.norm();
    for (size_t i = 0; i < scene.matches.size(); ++i) {
      EXPECT_TRUE(c.inlier[i]);
      if (!c.point[i]) continue;  // next to the epipole
      EXPECT_NEAR((*c.point[i] * baseline - scene.points[i]).norm(), 0,
                  0.02 * scene.points[i].norm());
    }
  }
}

// Bounds are about 1.5 times the medians found; the first-order prediction for 300 matches and 3
// degrees is 0.8 degrees of direction.
TEST(TwoView, GeneralScene) {
  SceneOptions options;
  options.num_matches = 300;
  Statistics clean = RunTrials(options, 60, 2);
  EXPECT_GE(clean.count[TwoViewStatus::kOk], 58);
  EXPECT_EQ(clean.truth_missing, 0);
  EXPECT_LT(Statistics::Median(clean.rotation_rad), Radians(0.15));
  EXPECT_LT(Statistics::Median(clean.direction_rad), Radians(1.5));
  options.outlier_share = 0.4;
  Statistics dirty = RunTrials(options, 60, 3);
  EXPECT_GE(dirty.count[TwoViewStatus::kOk], 55);
  EXPECT_EQ(dirty.truth_missing, 0);
  EXPECT_LT(Statistics::Median(dirty.rotation_rad), Radians(0.25));
  EXPECT_LT(Statistics::Median(dirty.direction_rad), Radians(2.5));
}

TEST(TwoView, ForwardMotion) {
  SceneOptions options;
  options.num_matches = 300;
  options.forward = true;
  options.parallax_rad = Radians(10);  // as seen from the side; from the front it is far less
  options.outlier_share = 0.2;
  Statistics statistics = RunTrials(options, 40, 4);
  EXPECT_GE(statistics.count[TwoViewStatus::kOk], 38);
  EXPECT_EQ(statistics.truth_missing, 0);
  EXPECT_LT(Statistics::Median(statistics.rotation_rad), Radians(0.15));
  EXPECT_LT(Statistics::Median(statistics.direction_rad), Radians(1));
}

TEST(TwoView, PlaneHasTheTruthAmongItsCandidates) {
  for (const SceneShape shape : {SceneShape::kSlantedPlane, SceneShape::kFrontoParallel}) {
    for (const double outlier_share : {0.0, 0.4}) {
      SceneOptions options;
      options.shape = shape;
      options.num_matches = 300;
      options.parallax_rad = Radians(5);
      options.outlier_share = outlier_share;
      Statistics statistics = RunTrials(options, 40, 5);
      EXPECT_GE(statistics.Accepted(), 37);
      EXPECT_LE(statistics.truth_missing, 1);
      EXPECT_LT(Statistics::Median(statistics.rotation_rad), Radians(0.3));
      EXPECT_LT(Statistics::Median(statistics.direction_rad), Radians(3));
    }
  }
}

TEST(TwoView, PlaneIsToldAsSuchAndIsMostlyAmbiguous) {
  SceneMaker maker(6);
  SceneOptions options;
  options.shape = SceneShape::kSlantedPlane;
  options.num_matches = 300;
  int planes = 0, ambiguous = 0;
  for (int trial = 0; trial < 20; ++trial) {
    const TwoViewResult result = Estimate(maker.Make(options), trial);
    planes += result.model == TwoViewModel::kHomography;
    ambiguous += result.status == TwoViewStatus::kAmbiguous;
    EXPECT_TRUE(std::is_sorted(result.candidates.begin(), result.candidates.end(),
                               [](const auto& a, const auto& b) { return a.cost < b.cost - 1; }));
  }
  EXPECT_GE(planes, 19);
  EXPECT_GE(ambiguous, 10);
  options.shape = SceneShape::kGeneral;
  for (int trial = 0; trial < 20; ++trial) {
    EXPECT_EQ(Estimate(maker.Make(options), trial).model, TwoViewModel::kEssential);
  }
}

TEST(TwoView, PureRotationIsRejected) {
  for (const double outlier_share : {0.0, 0.2, 0.4}) {
    SceneOptions options;
    options.num_matches = 300;
    options.parallax_rad = 0;
    options.outlier_share = outlier_share;
    Statistics statistics = RunTrials(options, 60, 7);
    EXPECT_EQ(statistics.Accepted(), 0) << outlier_share;
    EXPECT_GE(statistics.count[TwoViewStatus::kTooLittleParallax], 55);
  }
}

TEST(TwoView, TinyBaselineIsRejected) {
  SceneOptions options;
  options.parallax_rad = Radians(0.3);
  Statistics statistics = RunTrials(options, 60, 8);
  EXPECT_EQ(statistics.Accepted(), 0);
  // And the same image twice.
  options.parallax_rad = 0;
  options.rotation_sigma_rad = 0;
  statistics = RunTrials(options, 10, 9);
  EXPECT_EQ(statistics.count[TwoViewStatus::kTooLittleParallax], 10);
}

TEST(TwoView, OutliersAloneAreRejected) {
  SceneOptions options;
  options.outlier_share = 1;
  EXPECT_EQ(RunTrials(options, 30, 10).Accepted(), 0);
}

TEST(TwoView, TooFewMatches) {
  SceneMaker maker(11);
  const Scene scene = maker.Make({.num_matches = 49});
  EXPECT_EQ(Estimate(scene).status, TwoViewStatus::kTooFewMatches);
  EXPECT_EQ(Estimate(Scene{}).status, TwoViewStatus::kTooFewMatches);
}

TEST(TwoView, MatchesOnOneLineGiveNoMap) {
  SceneMaker maker(12);
  Scene scene = maker.Make({.num_matches = 200, .noise_px = 0});
  const Camera camera = SceneCamera();
  for (size_t i = 0; i < scene.matches.size(); ++i) {
    const double s = static_cast<double>(i) / 200;
    const Eigen::Vector3d x = Eigen::Vector3d(-1 + 2 * s, -0.5 + s, 4 + s);
    scene.matches[i].first_px = camera.Project(x);
    scene.matches[i].second_px = camera.Project(scene.second_from_first * x);
  }
  EXPECT_NE(Estimate(scene).status, TwoViewStatus::kOk);
  // All in one place.
  for (TwoViewMatch& m : scene.matches) m = scene.matches[0];
  EXPECT_TRUE(Estimate(scene).candidates.empty());
}

TEST(TwoView, InvalidInputIsRejected) {
  SceneMaker maker(13);
  const Scene scene = maker.Make({});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Scene bad = scene;
  bad.matches[3].second_px.y() = nan;
  EXPECT_EQ(Estimate(bad).status, TwoViewStatus::kInvalidInput);
  bad = scene;
  bad.matches[3].first_px.x() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(Estimate(bad).status, TwoViewStatus::kInvalidInput);
  for (const double sigma : {0.0, -1.0, nan}) {
    bad = scene;
    bad.matches.back().first_sigma_px = sigma;
    EXPECT_EQ(Estimate(bad).status, TwoViewStatus::kInvalidInput);
  }
}

TEST(TwoView, SameSeedSameResult) {
  SceneMaker maker(14);
  SceneOptions options;
  options.num_matches = 600;  // more than RANSAC looks at
  options.outlier_share = 0.3;
  const Scene scene = maker.Make(options);
  const TwoViewResult a = Estimate(scene, 42), b = Estimate(scene, 42);
  ASSERT_EQ(a.status, TwoViewStatus::kOk);
  ASSERT_EQ(a.candidates.size(), b.candidates.size());
  EXPECT_EQ(a.essential_score, b.essential_score);
  EXPECT_EQ(a.candidates[0].second_from_first.translation,
            b.candidates[0].second_from_first.translation);
  EXPECT_EQ(a.candidates[0].second_from_first.rotation.coeffs(),
            b.candidates[0].second_from_first.rotation.coeffs());
  EXPECT_EQ(a.candidates[0].point, b.candidates[0].point);
}

TEST(TwoView, CandidateIsConsistentWithItself) {
  SceneMaker maker(15);
  const Camera camera = SceneCamera();
  SceneOptions scene_options;
  scene_options.outlier_share = 0.2;
  const TwoViewOptions options;
  for (int trial = 0; trial < 20; ++trial) {
    const Scene scene = maker.Make(scene_options);
    for (const TwoViewCandidate& c : Estimate(scene, trial).candidates) {
      ASSERT_EQ(c.inlier.size(), scene.matches.size());
      ASSERT_EQ(c.point.size(), scene.matches.size());
      int points = 0, outliers_in = 0;
      for (size_t i = 0; i < scene.matches.size(); ++i) {
        outliers_in += c.inlier[i] && scene.is_outlier[i];
        if (!c.point[i]) continue;
        ++points;
        EXPECT_TRUE(c.inlier[i]);
        const Eigen::Vector3d x1 = *c.point[i], x2 = c.second_from_first * x1;
        EXPECT_GT(std::min(x1.z(), x2.z()), 0);
        EXPECT_LT((camera.Project(x1) - scene.matches[i].first_px).norm(), 2.5);
        EXPECT_LT((camera.Project(x2) - scene.matches[i].second_px).norm(), 2.5);
      }
      EXPECT_EQ(points, c.num_points);
      EXPECT_EQ(std::count(c.inlier.begin(), c.inlier.end(), true), c.num_inliers);
      EXPECT_GE(c.num_points, options.min_points);
      EXPECT_GE(c.supported_parallax_rad, options.min_parallax_rad);
      // An outlier hides in the 5.5 px wide band around its epipolar line: about 4 % of them.
      EXPECT_LE(outliers_in, 8);
    }
  }
}

TEST(TwoView, FewPointsNeedMoreParallax) {
  SceneMaker maker(17);
  SceneOptions scene_options;
  scene_options.num_matches = 100;
  const Scene scene = maker.Make(scene_options);
  TwoViewOptions options;
  options.points_for_min_parallax = 0;
  const TwoViewResult plain = Estimate(scene, 1, options);
  ASSERT_EQ(plain.status, TwoViewStatus::kOk);
  const TwoViewCandidate& motion = plain.candidates.front();
  // Between what all points need, and what so few of them do.
  options.min_parallax_rad = 0.5 * motion.supported_parallax_rad;
  options.points_for_min_parallax = 3 * motion.num_points;
  EXPECT_EQ(Estimate(scene, 1, options).status, TwoViewStatus::kOk);
  options.points_for_min_parallax = 5 * motion.num_points;
  EXPECT_EQ(Estimate(scene, 1, options).status, TwoViewStatus::kTooLittleParallax);
}

TEST(TwoView, FindsTheNoiseThatIsThere) {
  SceneMaker maker(16);
  SceneOptions options;
  options.num_matches = 400;
  for (const double noise_px : {0.4, 0.7, 1.0}) {
    options.noise_px = noise_px;
    EXPECT_NEAR(Estimate(maker.Make(options)).noise_scale, noise_px, 0.2 * noise_px);
  }
}

TEST(TwoView, OptionsAreValidated) {
  EXPECT_FALSE(TwoViewOptions{}.Validate());
  EXPECT_TRUE(TwoViewOptions{.min_matches = 4}.Validate());
  EXPECT_TRUE(TwoViewOptions{.min_points = 0}.Validate());
  EXPECT_TRUE(TwoViewOptions{.min_parallax_rad = 0}.Validate());
  EXPECT_TRUE(TwoViewOptions{.max_rotation_share = 1.5}.Validate());
  EXPECT_TRUE(TwoViewOptions{.min_noise_scale = 0}.Validate());
  EXPECT_TRUE(TwoViewOptions{.max_sampled_matches = 49}.Validate());
  TwoViewOptions options;
  options.ransac.confidence = 1;
  EXPECT_TRUE(options.Validate());
  options = {};
  options.ransac.max_iterations = 0;
  EXPECT_TRUE(options.Validate());
}

}  // namespace
}  // namespace vpslam
