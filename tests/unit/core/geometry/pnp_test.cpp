#include "core/geometry/pnp.h"

#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "core/geometry/p3p.h"
#include "tests/unit/core/geometry/two_view_scene.h"

namespace vpslam {
namespace {

struct PnpScene {
  SE3 cam_from_world;
  std::vector<PnpMatch> matches;
  std::vector<bool> is_outlier;
};

PnpScene MakePnp(SceneMaker& maker, int count, double noise_px, double outlier_share,
                 bool plane = false) {
  const Camera camera = SceneCamera();
  PnpScene scene;
  scene.cam_from_world = SE3(ExpSo3(maker.NormalVector(1)), maker.NormalVector(5));
  const SE3 world_from_cam = scene.cam_from_world.Inverse();
  for (int i = 0; i < count; ++i) {
    const Eigen::Vector2d px(maker.Uniform(0, 640), maker.Uniform(0, 480));
    const Eigen::Vector3d ray = camera.Unproject(px);
    const double depth = plane ? 4 / (1 + 0.4 * ray.x()) : maker.Uniform(2, 8);
    PnpMatch m;
    m.point_in_world = world_from_cam * Eigen::Vector3d(depth * ray);
    m.position_px = px + maker.NormalVector(noise_px).head<2>();
    const bool outlier = i < outlier_share * count;
    if (outlier) m.position_px = {maker.Uniform(0, 640), maker.Uniform(0, 480)};
    scene.matches.push_back(m);
    scene.is_outlier.push_back(outlier);
  }
  return scene;
}

double CenterError(const SE3& a, const SE3& b) { return (a.Center() - b.Center()).norm(); }

TEST(P3p, TruePoseIsAmongTheSolutionsAndAllOfThemFit) {
  const Camera camera = SceneCamera();
  SceneMaker maker(1);
  int found = 0;
  constexpr int kTrials = 1000;
  for (int trial = 0; trial < kTrials; ++trial) {
    const PnpScene scene = MakePnp(maker, 3, 0, 0, trial % 2);
    std::array<Eigen::Vector3d, 3> points;
    std::array<Eigen::Vector2d, 3> rays;
    for (int i = 0; i < 3; ++i) {
      points[i] = scene.matches[i].point_in_world;
      rays[i] = camera.Unproject(scene.matches[i].position_px).head<2>();
    }
    const std::vector<SE3> poses = SolveP3p(points, rays);
    EXPECT_LE(poses.size(), 4u);
    bool hit = false;
    for (const SE3& pose : poses) {
      hit |= CenterError(pose, scene.cam_from_world) < 1e-4 &&
             RotationError_rad(pose, scene.cam_from_world) < 1e-4;
      for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d x = pose * points[i];
        EXPECT_GT(x.z(), 0);
        EXPECT_NEAR((camera.Project(x) - scene.matches[i].position_px).norm(), 0, 1e-2);
      }
    }
    found += hit;
  }
  EXPECT_GE(found, 0.99 * kTrials);
}

TEST(P3p, SymmetricTriangleSeenFromAbove) {
  // Isosceles in many ways, where eliminations divide by zero.
  const double h = std::sqrt(3.0) / 2;
  const std::array<Eigen::Vector3d, 3> points = {
      Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(-h, -0.5, 0), Eigen::Vector3d(h, -0.5, 0)};
  const SE3 truth(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 0, 3));
  std::array<Eigen::Vector2d, 3> rays;
  for (int i = 0; i < 3; ++i) rays[i] = (truth * points[i]).hnormalized();
  double nearest = 10;
  for (const SE3& pose : SolveP3p(points, rays)) {
    nearest = std::min(nearest, CenterError(pose, truth));
  }
  EXPECT_LT(nearest, 1e-5);
}

TEST(P3p, RejectsPointsOnALineAndInvalidOnes) {
  const std::array<Eigen::Vector2d, 3> rays = {Eigen::Vector2d(0, 0), Eigen::Vector2d(0.1, 0),
                                               Eigen::Vector2d(0.2, 0.1)};
  std::array<Eigen::Vector3d, 3> points = {Eigen::Vector3d(0, 0, 1), Eigen::Vector3d(1, 1, 2),
                                           Eigen::Vector3d(2, 2, 3)};
  EXPECT_TRUE(SolveP3p(points, rays).empty());
  points[1] = points[0];
  EXPECT_TRUE(SolveP3p(points, rays).empty());
  points[1].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(SolveP3p(points, rays).empty());
}

TEST(Pnp, FindsThePoseAmongOutliers) {
  SceneMaker maker(2);
  for (const bool plane : {false, true}) {
    for (int trial = 0; trial < 50; ++trial) {
      const PnpScene scene = MakePnp(maker, 100, 1, 0.5, plane);
      std::mt19937_64 rng(trial);
      const auto result = EstimatePnp(SceneCamera(), scene.matches, {}, rng);
      ASSERT_TRUE(result) << trial;
      // 50 points at 1 px: about 0.05 degrees and 5 mm at depth 5, four times worse at worst.
      EXPECT_LT(RotationError_rad(result->cam_from_world, scene.cam_from_world), Radians(0.4));
      EXPECT_LT(CenterError(result->cam_from_world, scene.cam_from_world), 0.04);
      int right = 0, wrong = 0;
      for (size_t i = 0; i < scene.matches.size(); ++i) {
        (scene.is_outlier[i] ? wrong : right) += result->inlier[i];
      }
      EXPECT_EQ(right + wrong, result->num_inliers);
      EXPECT_GE(right, 40);
      EXPECT_LE(wrong, 2);
    }
  }
}

TEST(Pnp, OutliersAloneGiveNoPose) {
  SceneMaker maker(3);
  for (int trial = 0; trial < 20; ++trial) {
    std::mt19937_64 rng(trial);
    EXPECT_FALSE(EstimatePnp(SceneCamera(), MakePnp(maker, 100, 1, 1).matches, {}, rng));
  }
}

TEST(Pnp, RejectsTooFewAndDegenerateMatches) {
  SceneMaker maker(4);
  std::mt19937_64 rng(1);
  const PnpScene scene = MakePnp(maker, 14, 1, 0);
  EXPECT_FALSE(EstimatePnp(SceneCamera(), scene.matches, {}, rng));
  EXPECT_FALSE(EstimatePnp(SceneCamera(), {}, {}, rng));
  const std::vector<PnpMatch> repeated(50, scene.matches[0]);
  EXPECT_FALSE(EstimatePnp(SceneCamera(), repeated, {}, rng));
  // Exactly on a line: any rotation about it fits.
  std::vector<PnpMatch> line;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d x(-1 + 0.04 * i, 0.3, 4);
    line.push_back({x, SceneCamera().Project(x)});
  }
  EXPECT_FALSE(EstimatePnp(SceneCamera(), line, {}, rng));
}

TEST(Pnp, MatchesThatAreNotFiniteAreOutliers) {
  SceneMaker maker(5);
  PnpScene scene = MakePnp(maker, 60, 1, 0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  scene.matches[0].position_px.x() = nan;
  scene.matches[1].point_in_world.z() = nan;
  scene.matches[2].sigma_px = 0;
  std::mt19937_64 rng(1);
  const auto result = EstimatePnp(SceneCamera(), scene.matches, {}, rng);
  ASSERT_TRUE(result);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(result->inlier[i]);
  EXPECT_GE(result->num_inliers, 45);
}

TEST(Pnp, SameSeedSameResult) {
  SceneMaker maker(6);
  const PnpScene scene = MakePnp(maker, 80, 1, 0.4);
  std::mt19937_64 rng_a(9), rng_b(9);
  const auto a = EstimatePnp(SceneCamera(), scene.matches, {}, rng_a);
  const auto b = EstimatePnp(SceneCamera(), scene.matches, {}, rng_b);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->cam_from_world.translation, b->cam_from_world.translation);
  EXPECT_EQ(a->cam_from_world.rotation.coeffs(), b->cam_from_world.rotation.coeffs());
  EXPECT_EQ(a->inlier, b->inlier);
}

TEST(RefinePose, ConvergesFromAfarInSpiteOfAFewOutliers) {
  SceneMaker maker(7);
  for (int trial = 0; trial < 100; ++trial) {
    const PnpScene scene = MakePnp(maker, 100, 1, 0.05);
    SE3 pose =
        Retract(scene.cam_from_world,
                (Vector6d() << maker.NormalVector(0.1), maker.NormalVector(0.03)).finished());
    ASSERT_TRUE(RefinePose(SceneCamera(), scene.matches, 30, &pose));
    EXPECT_LT(RotationError_rad(pose, scene.cam_from_world), Radians(0.5));
    EXPECT_LT(CenterError(pose, scene.cam_from_world), 0.06);
  }
}

TEST(RefinePose, NeedsThreePointsInFront) {
  SceneMaker maker(8);
  const PnpScene scene = MakePnp(maker, 10, 1, 0);
  SE3 pose = scene.cam_from_world;
  EXPECT_FALSE(RefinePose(SceneCamera(), std::span(scene.matches).first(2), 10, &pose));
  pose = SE3(ExpSo3({0, M_PI, 0}), Eigen::Vector3d::Zero()) * pose;
  const SE3 before = pose;
  EXPECT_FALSE(RefinePose(SceneCamera(), scene.matches, 10, &pose));
  EXPECT_EQ(pose.translation, before.translation);
}

TEST(Pnp, OptionsAreValidated) {
  EXPECT_FALSE(PnpOptions{}.Validate());
  EXPECT_TRUE(PnpOptions{.min_inliers = 3}.Validate());
}

}  // namespace
}  // namespace vpslam
