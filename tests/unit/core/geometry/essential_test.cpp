#include "core/geometry/essential.h"

#include <algorithm>
#include <limits>

#include <Eigen/SVD>
#include <gtest/gtest.h>

#include "core/geometry/chi_square.h"
#include "core/geometry/motion_refinement.h"
#include "tests/unit/core/geometry/two_view_scene.h"

namespace vpslam {
namespace {

std::vector<RayMatch> Rays(const Scene& scene) {
  std::vector<RayMatch> rays;
  for (const TwoViewMatch& m : scene.matches) {
    rays.push_back(MakeRayMatch(SceneCamera(), m.first_px, m.second_px, 1, 1));
  }
  return rays;
}

/// Distance of two essential matrices of norm sqrt(2) up to sign.
double Distance(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return std::min((a - b).norm(), (a + b).norm());
}

SE3 UnitMotion(const Scene& scene) {
  SE3 motion = scene.second_from_first;
  motion.translation.normalize();
  return motion;
}

TEST(FivePoint, FindsTheTrueMotionAmongEssentialMatrices) {
  SceneMaker maker(1);
  int found = 0, solutions = 0;
  constexpr int kTrials = 1000;
  for (int trial = 0; trial < kTrials; ++trial) {
    SceneOptions options;
    options.noise_px = 0;
    options.num_matches = 5;
    options.parallax_rad = Radians(maker.Uniform(2, 20));
    options.shape = trial % 2 ? SceneShape::kSlantedPlane : SceneShape::kGeneral;
    options.forward = trial % 5 == 0;
    const Scene scene = maker.Make(options);
    std::array<Eigen::Vector2d, 5> first, second;
    const std::vector<RayMatch> rays = Rays(scene);
    for (int i = 0; i < 5; ++i) first[i] = rays[i].first, second[i] = rays[i].second;
    double nearest = 10;
    for (const Eigen::Matrix3d& e : SolveFivePoint(first, second)) {
      ++solutions;
      nearest = std::min(nearest, Distance(e, EssentialFromMotion(UnitMotion(scene))));
      for (int i = 0; i < 5; ++i) {
        EXPECT_NEAR(second[i].homogeneous().dot(e * first[i].homogeneous()), 0, 1e-9);
      }
      EXPECT_NEAR(e.norm(), std::sqrt(2.0), 1e-9);
    }
    found += nearest < 1e-4;
  }
  // The few that are missed are next to a double root, or badly conditioned.
  EXPECT_GE(found, 0.98 * kTrials);
  EXPECT_LE(solutions, 8 * kTrials);  // about 4 on average
}

TEST(FivePoint, SolutionsHaveTwoEqualSingularValues) {
  SceneMaker maker(2);
  int good = 0, all = 0;
  for (int trial = 0; trial < 200; ++trial) {
    SceneOptions options;
    options.num_matches = 5;
    options.parallax_rad = Radians(10);
    const std::vector<RayMatch> rays = Rays(maker.Make(options));
    std::array<Eigen::Vector2d, 5> first, second;
    for (int i = 0; i < 5; ++i) first[i] = rays[i].first, second[i] = rays[i].second;
    for (const Eigen::Matrix3d& e : SolveFivePoint(first, second)) {
      const Eigen::Vector3d s = Eigen::JacobiSVD<Eigen::Matrix3d>(e).singularValues();
      ++all;
      good += std::abs(s[0] - 1) < 1e-3 && std::abs(s[1] - 1) < 1e-3 && s[2] < 1e-3;
    }
  }
  EXPECT_GT(good, 0.98 * all);
}

TEST(FivePoint, RejectsDegeneratePoints) {
  std::array<Eigen::Vector2d, 5> same;
  same.fill(Eigen::Vector2d(0.1, 0.2));
  EXPECT_TRUE(SolveFivePoint(same, same).empty());
  std::array<Eigen::Vector2d, 5> nan = same;
  nan[2].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(SolveFivePoint(nan, same).empty());
  // On a line, in both images: many solutions or none, but no crash and none that is not finite.
  std::array<Eigen::Vector2d, 5> line, moved;
  for (int i = 0; i < 5; ++i) {
    line[i] = Eigen::Vector2d(0.1 * i, 0.05 * i);
    moved[i] = line[i] + Eigen::Vector2d(0.02 + 0.001 * i * i, 0.01 + 0.0005 * i * i);
  }
  for (const Eigen::Matrix3d& e : SolveFivePoint(line, moved)) EXPECT_TRUE(e.allFinite());
}

TEST(Essential, DecompositionHoldsTheMotion) {
  SceneMaker maker(3);
  for (int trial = 0; trial < 1000; ++trial) {
    const SE3 motion(ExpSo3(maker.NormalVector(1)), maker.NormalVector(1).normalized());
    double nearest = 10;
    for (const SE3& m : DecomposeEssential(-3 * EssentialFromMotion(motion))) {
      EXPECT_LT(Distance(EssentialFromMotion(m), EssentialFromMotion(motion)), 1e-9);
      nearest = std::min(nearest, RotationError_rad(m, motion) + DirectionError_rad(m, motion));
    }
    EXPECT_LT(nearest, 1e-7);
  }
}

TEST(Essential, SampsonErrorIsChiSquare) {
  SceneMaker maker(4);
  SceneOptions options;
  options.num_matches = 5000;
  const Scene scene = maker.Make(options);
  const Eigen::Matrix3d e = EssentialFromMotion(UnitMotion(scene));
  double sum = 0;
  int inliers = 0;
  for (const RayMatch& m : Rays(scene)) {
    sum += SampsonChi2(e, m);
    inliers += SampsonChi2(e, m) < kChi2Dof1;
  }
  EXPECT_NEAR(sum / 5000, 1, 0.08);  // standard error sqrt(2 / 5000) = 0.02
  EXPECT_NEAR(inliers / 5000.0, 0.95, 0.012);
}

TEST(Essential, ScoreGivesUpOnlyWhereItCannotWin) {
  SceneMaker maker(5);
  SceneOptions options;
  options.outlier_share = 0.3;
  const Scene scene = maker.Make(options);
  const std::vector<RayMatch> rays = Rays(scene);
  const Eigen::Matrix3d e = EssentialFromMotion(UnitMotion(scene));
  const double score = EssentialScore(e, rays);
  EXPECT_GT(score, 0);
  EXPECT_EQ(EssentialScore(e, rays, 0.999 * score), score);
  EXPECT_EQ(EssentialScore(e, rays, 1.001 * score), 0);
}

TEST(Essential, RansacFindsTheMotionAmongOutliers) {
  SceneMaker maker(6);
  int good = 0;
  constexpr int kTrials = 40;
  for (int trial = 0; trial < kTrials; ++trial) {
    SceneOptions options;
    options.outlier_share = 0.4;
    options.parallax_rad = Radians(5);
    const Scene scene = maker.Make(options);
    std::mt19937_64 rng(trial);
    const EssentialEstimate estimate = EstimateEssential(Rays(scene), {}, rng);
    double error_rad = 10;
    for (const SE3& m : DecomposeEssential(EssentialFromMotion(estimate.motion))) {
      error_rad = std::min(error_rad, std::max(DirectionError_rad(m, UnitMotion(scene)),
                                               RotationError_rad(m, UnitMotion(scene))));
    }
    good += error_rad < Radians(6);  // 4 sigma
  }
  EXPECT_GE(good, 0.9 * kTrials);
}

TEST(Essential, RansacNeedsFiveMatches) {
  SceneMaker maker(7);
  std::mt19937_64 rng(1);
  const std::vector<RayMatch> rays = Rays(maker.Make({.num_matches = 4}));
  EXPECT_EQ(EstimateEssential(rays, {}, rng).score, 0);
}

TEST(MotionRefinement, LowersTheCostToAMinimumWithTheSpreadItPredicts) {
  SceneMaker maker(8);
  double normalised = 0;
  constexpr int kTrials = 100;
  for (int trial = 0; trial < kTrials; ++trial) {
    SceneOptions options;
    options.parallax_rad = Radians(8);
    const Scene scene = maker.Make(options);
    const std::vector<RayMatch> rays = Rays(scene);
    SE3 start = UnitMotion(scene);
    start.rotation = ExpSo3(maker.NormalVector(0.004)) * start.rotation;
    start.translation = (start.translation + maker.NormalVector(0.05)).normalized();
    SE3 motion = start;
    // No truncation: the estimate is then the least squares one, with no inliers to choose.
    const MotionRefinement result =
        RefineMotion(rays, {.max_iterations = 30, .max_chi2 = 1e9}, &motion);
    EXPECT_NEAR(motion.translation.norm(), 1, 1e-12);
    const auto cost_of = [&rays](SE3 m) {
      return RefineMotion(rays, {.max_iterations = 0, .max_chi2 = 1e9}, &m).cost;
    };
    EXPECT_LE(result.cost, cost_of(start));
    for (int k = 0; k < 12; ++k) {
      Vector6d xi = Vector6d::Zero();
      xi[k / 2] = k % 2 ? 1e-3 : -1e-3;
      SE3 moved(ExpSo3(xi.tail<3>()) * motion.rotation, motion.translation + xi.head<3>());
      EXPECT_GE(cost_of(moved), result.cost - 1e-3 * result.cost);
    }
    const double error = DirectionError_rad(motion, UnitMotion(scene));
    normalised += error * error / (result.direction_sigma_rad * result.direction_sigma_rad);
  }
  // Squared error over the largest variance: between 1 (one direction dominates) and 2.
  EXPECT_GT(normalised / kTrials, 0.7);
  EXPECT_LT(normalised / kTrials, 2.6);
}

}  // namespace
}  // namespace vpslam
