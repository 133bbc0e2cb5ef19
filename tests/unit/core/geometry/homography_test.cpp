#include "core/geometry/homography.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "core/geometry/chi_square.h"
#include "core/geometry/rotation_only.h"
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

TEST(FourPoint, FitsFourPointsAndPredictsTheRestOfThePlane) {
  SceneMaker maker(1);
  int solved = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    SceneOptions options;
    options.shape = SceneShape::kSlantedPlane;
    options.noise_px = 0;
    options.num_matches = 10;
    options.parallax_rad = Radians(20);
    const std::vector<RayMatch> rays = Rays(maker.Make(options));
    std::array<Eigen::Vector2d, 4> first, second;
    for (int i = 0; i < 4; ++i) first[i] = rays[i].first, second[i] = rays[i].second;
    const auto h = SolveFourPoint(first, second);
    if (!h) continue;
    ++solved;
    for (const RayMatch& ray : rays) {
      const Eigen::Vector3d x = *h * ray.first.homogeneous();
      EXPECT_GT(x.z(), 0);
      EXPECT_NEAR((x.hnormalized() - ray.second).norm(), 0, 1e-6);
    }
  }
  EXPECT_GT(solved, 980);
}

TEST(FourPoint, RejectsCollinearTwistedAndInvalidPoints) {
  const std::array<Eigen::Vector2d, 4> square = {Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0),
                                                 Eigen::Vector2d(1, 1), Eigen::Vector2d(0, 1)};
  EXPECT_TRUE(SolveFourPoint(square, square));
  std::array<Eigen::Vector2d, 4> bad = square;
  bad[2] = Eigen::Vector2d(2, 0);  // three on a line
  EXPECT_FALSE(SolveFourPoint(bad, square));
  EXPECT_FALSE(SolveFourPoint(square, bad));
  bad = square;
  std::swap(bad[0], bad[1]);  // a bow tie
  EXPECT_FALSE(SolveFourPoint(square, bad));
  bad = square;
  bad[0].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(SolveFourPoint(bad, square));
}

TEST(Homography, DecompositionHoldsTheMotion) {
  SceneMaker maker(2);
  for (int trial = 0; trial < 1000; ++trial) {
    const SE3 motion(ExpSo3(maker.NormalVector(0.3)), maker.NormalVector(1).normalized());
    Eigen::Vector3d normal = maker.NormalVector(1);
    normal /= normal.norm() * maker.Uniform(1.2, 50);  // 1.2 to 50 baselines away
    const Eigen::Matrix3d h = motion.RotationMatrix() + motion.translation * normal.transpose();
    double nearest = 10;
    const std::vector<SE3> motions = DecomposeHomography(-0.3 * h);
    EXPECT_LE(motions.size(), 4u);
    for (const SE3& m : motions) {
      EXPECT_NEAR(m.translation.norm(), 1, 1e-9);
      nearest = std::min(nearest, RotationError_rad(m, motion) + DirectionError_rad(m, motion));
    }
    EXPECT_LT(nearest, 1e-5) << trial;
  }
}

TEST(Homography, TranslationAlongTheNormalIsFound) {
  const SE3 motion(ExpSo3({0.1, 0.2, 0}), Eigen::Vector3d(0, 0, -1));
  const Eigen::Matrix3d h = motion.RotationMatrix() + 0.1 * motion.translation *
                                                          motion.translation.transpose() *
                                                          motion.RotationMatrix();
  double nearest = 10;
  for (const SE3& m : DecomposeHomography(h)) {
    nearest = std::min(nearest, RotationError_rad(m, motion) + DirectionError_rad(m, motion));
  }
  EXPECT_LT(nearest, 1e-5);
}

TEST(Homography, ARotationHasNoDecomposition) {
  EXPECT_TRUE(DecomposeHomography(ExpSo3({0.1, -0.2, 0.3}).toRotationMatrix()).empty());
  EXPECT_TRUE(DecomposeHomography(Eigen::Matrix3d::Zero()).empty());
  EXPECT_TRUE(
      DecomposeHomography(Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN()))
          .empty());
}

TEST(Homography, RansacExplainsAPlaneAmongOutliers) {
  SceneMaker maker(3);
  for (int trial = 0; trial < 30; ++trial) {
    SceneOptions options;
    options.shape = SceneShape::kSlantedPlane;
    options.outlier_share = 0.4;
    const Scene scene = maker.Make(options);
    const std::vector<RayMatch> rays = Rays(scene);
    std::mt19937_64 rng(trial);
    const HomographyEstimate estimate = EstimateHomography(rays, {}, rng);
    int inliers = 0, wrong = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
      const bool inlier = TransferChi2(estimate.homography, rays[i]) < kChi2Dof2;
      (scene.is_outlier[i] ? wrong : inliers) += inlier;
    }
    EXPECT_GE(inliers, 0.85 * 120);  // of 120 true ones 95 % +- 2 % at the truth
    EXPECT_LE(wrong, 4);             // 80 outliers in 200 px x 200 px, gate of 38 px^2: 0.1
  }
}

TEST(Homography, ScoreGivesUpOnlyWhereItCannotWin) {
  SceneMaker maker(4);
  const std::vector<RayMatch> rays = Rays(maker.Make({.shape = SceneShape::kSlantedPlane}));
  std::mt19937_64 rng(1);
  const Eigen::Matrix3d h = EstimateHomography(rays, {}, rng).homography;
  const double score = HomographyScore(h, rays);
  EXPECT_GT(score, 0);
  EXPECT_EQ(HomographyScore(h, rays, 0.999 * score), score);
  EXPECT_EQ(HomographyScore(h, rays, 1.001 * score), 0);
}

TEST(RotationOnly, FindsTheRotationAmongOutliers) {
  SceneMaker maker(5);
  for (int trial = 0; trial < 50; ++trial) {
    SceneOptions options;
    options.parallax_rad = 0;
    options.outlier_share = 0.4;
    const Scene scene = maker.Make(options);
    std::mt19937_64 rng(trial);
    const RotationEstimate estimate = EstimateRotation(Rays(scene), {}, rng);
    EXPECT_GE(estimate.num_inliers, 0.88 * 120);
    EXPECT_LE(estimate.num_inliers, 124);
    // Least squares would give 0.015 degrees about each axis, 0.03 about the optical one; the count
    // of inliers, which chooses here, is several times less sharp.
    EXPECT_LT(AngleBetween_rad(estimate.second_from_first, scene.second_from_first.rotation),
              Radians(0.3));
  }
}

TEST(RotationOnly, DoesNotExplainATranslation) {
  SceneMaker maker(6);
  SceneOptions options;
  options.parallax_rad = Radians(5);
  std::mt19937_64 rng(1);
  EXPECT_LT(EstimateRotation(Rays(maker.Make(options)), {}, rng).num_inliers, 80);
  EXPECT_EQ(EstimateRotation({}, {}, rng).num_inliers, 0);
}

}  // namespace
}  // namespace vpslam
