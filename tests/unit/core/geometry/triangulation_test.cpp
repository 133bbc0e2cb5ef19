#include "core/geometry/triangulation.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/core/geometry/two_view_scene.h"

namespace vpslam {
namespace {

RayMatch Rays(const Camera& camera, const TwoViewMatch& m) {
  return MakeRayMatch(camera, m.first_px, m.second_px, m.first_sigma_px, m.second_sigma_px);
}

double SquaredReprojection(const Camera& camera, const SE3& second_from_first,
                           const TwoViewMatch& m, const Eigen::Vector3d& x) {
  return (camera.Project(x) - m.first_px).squaredNorm() / (m.first_sigma_px * m.first_sigma_px) +
         (camera.Project(second_from_first * x) - m.second_px).squaredNorm() /
             (m.second_sigma_px * m.second_sigma_px);
}

/// Cameras along an arc that look at the point from about 5 away.
std::vector<RayObservation> Observe(SceneMaker& maker, const Eigen::Vector3d& point, int count,
                                    double sigma) {
  std::vector<RayObservation> observations;
  for (int i = 0; i < count; ++i) {
    RayObservation o;
    const Eigen::Vector3d center =
        point + Eigen::Vector3d(maker.Uniform(-2, 2), maker.Uniform(-1, 1), -5);
    const Eigen::Quaterniond rotation = ExpSo3(maker.NormalVector(0.1));
    o.cam_from_world = SE3(rotation, -(rotation * center));
    const Eigen::Vector3d x = o.cam_from_world * point;
    o.sigma = sigma;
    o.position = x.head<2>() / x.z() + maker.NormalVector(sigma).head<2>();
    observations.push_back(o);
  }
  return observations;
}

TEST(TriangulateTwoView, IsExactWithoutNoise) {
  const Camera camera = SceneCamera();
  SceneMaker maker(1);
  SceneOptions options;
  options.noise_px = 0;
  options.num_matches = 1000;
  const Scene scene = maker.Make(options);
  for (size_t i = 0; i < scene.matches.size(); ++i) {
    double parallax_rad = 0;
    const auto x =
        TriangulateTwoView(scene.second_from_first, Rays(camera, scene.matches[i]), &parallax_rad);
    ASSERT_TRUE(x) << i;
    EXPECT_NEAR((*x - scene.points[i]).norm(), 0, 1e-8 * scene.points[i].norm());
    EXPECT_NEAR(parallax_rad,
                Parallax_rad(*x, Eigen::Vector3d::Zero(), scene.second_from_first.Center()), 1e-9);
  }
}

TEST(TriangulateTwoView, MinimisesTheReprojectionErrorWithUnequalSigmas) {
  const Camera camera = SceneCamera();
  SceneMaker maker(2);
  SceneOptions options;
  options.num_matches = 1000;
  options.parallax_rad = Radians(10);
  Scene scene = maker.Make(options);
  int tested = 0;
  for (TwoViewMatch& m : scene.matches) {
    m.first_sigma_px = maker.Uniform(0.5, 3);
    m.second_sigma_px = maker.Uniform(0.5, 3);
    const auto x = TriangulateTwoView(scene.second_from_first, Rays(camera, m));
    if (!x) continue;
    ++tested;
    // No neighbour is better, by more than what second order leaves: 1 % of a pixel squared.
    const double cost = SquaredReprojection(camera, scene.second_from_first, m, *x);
    for (int k = 0; k < 6; ++k) {
      const Eigen::Vector3d step = (k % 2 ? 1e-3 : -1e-3) * Eigen::Vector3d::Unit(k / 2);
      EXPECT_GT(SquaredReprojection(camera, scene.second_from_first, m, *x + step), cost - 1e-4);
    }
  }
  EXPECT_GT(tested, 950);
}

TEST(TriangulateTwoView, RejectsWhatIsBehindOrWithoutParallax) {
  const Camera camera = SceneCamera();
  const SE3 motion(Eigen::Quaterniond::Identity(), Eigen::Vector3d(-1, 0, 0));
  // The rays diverge: they meet behind both cameras.
  EXPECT_FALSE(TriangulateTwoView(motion, MakeRayMatch(camera, {300, 240}, {340, 240}, 1, 1)));
  EXPECT_TRUE(TriangulateTwoView(motion, MakeRayMatch(camera, {340, 240}, {300, 240}, 1, 1)));
  EXPECT_FALSE(TriangulateTwoView(motion, MakeRayMatch(camera, {300, 240}, {300, 240}, 1, 1)));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(TriangulateTwoView(motion, MakeRayMatch(camera, {nan, 240}, {300, 240}, 1, 1)));
  // No baseline at all.
  EXPECT_FALSE(TriangulateTwoView(SE3(), MakeRayMatch(camera, {340, 240}, {300, 240}, 1, 1)));
}

TEST(Triangulate, IsExactWithoutNoiseForAnyNumberOfViews) {
  SceneMaker maker(3);
  for (int trial = 0; trial < 1000; ++trial) {
    const Eigen::Vector3d point = maker.NormalVector(1000);  // far from the origin of the world
    const auto observations = Observe(maker, point, 2 + trial % 10, 0.0);
    std::vector<RayObservation> weighted = observations;
    for (RayObservation& o : weighted) o.sigma = 0.002;
    const auto linear = TriangulateLinear(weighted);
    const auto refined = Triangulate(weighted, {.min_parallax_rad = 0});
    ASSERT_TRUE(linear && refined) << trial;
    EXPECT_LT((*linear - point).norm(), 1e-5);
    EXPECT_LT((*refined - point).norm(), 1e-5);
  }
}

TEST(Triangulate, RefinementFindsTheMinimumAndBeatsTheLinearMethod) {
  SceneMaker maker(4);
  constexpr double kSigma = 0.004;  // 2 px
  double sum_linear = 0, sum_refined = 0;
  for (int trial = 0; trial < 300; ++trial) {
    auto observations = Observe(maker, maker.NormalVector(1), 8, kSigma);
    const auto linear = TriangulateLinear(observations);
    const auto refined = Triangulate(observations);
    ASSERT_TRUE(linear && refined);
    double cost_linear = 0, cost_refined = 0;
    for (const RayObservation& o : observations) {
      cost_linear += ReprojectionChi2(o, *linear);
      cost_refined += ReprojectionChi2(o, *refined);
    }
    EXPECT_LE(cost_refined, cost_linear + 1e-9);
    for (int k = 0; k < 6; ++k) {
      const Eigen::Vector3d moved =
          *refined + (k % 2 ? 1e-4 : -1e-4) * Eigen::Vector3d(Eigen::Vector3d::Unit(k / 2));
      double cost = 0;
      for (const RayObservation& o : observations) cost += ReprojectionChi2(o, moved);
      EXPECT_GE(cost, cost_refined - 1e-9);
    }
    sum_linear += cost_linear;
    sum_refined += cost_refined;
  }
  EXPECT_LT(sum_refined, sum_linear);
  // 16 measurements less 3 unknowns: 13 expected, with a standard error of sqrt(26 / 300) = 0.3.
  EXPECT_NEAR(sum_refined / 300, 13, 1.2);
}

TEST(Triangulate, RejectsDegenerateInput) {
  SceneMaker maker(5);
  const Eigen::Vector3d point(0, 0, 0);
  const auto observations = Observe(maker, point, 4, 0.001);
  EXPECT_TRUE(Triangulate(observations));
  EXPECT_FALSE(Triangulate(std::span(observations).first(1)));
  EXPECT_FALSE(Triangulate({}));
  const std::vector<RayObservation> repeated(3, observations[0]);
  EXPECT_FALSE(Triangulate(repeated));
  auto invalid = observations;
  invalid[2].position.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(Triangulate(invalid));
  invalid = observations;
  invalid[1].sigma = 0;
  EXPECT_FALSE(Triangulate(invalid));
  EXPECT_FALSE(Triangulate(observations, {.min_parallax_rad = 1.5}));
  // Seen from behind: cameras which look the other way.
  auto behind = observations;
  for (RayObservation& o : behind) {
    o.cam_from_world = SE3(ExpSo3({0, M_PI, 0}), Eigen::Vector3d::Zero()) * o.cam_from_world;
    const Eigen::Vector3d x = o.cam_from_world * point;
    o.position = x.head<2>() / x.z();
  }
  EXPECT_FALSE(Triangulate(behind));
}

TEST(Triangulate, OptionsAreValidated) {
  EXPECT_FALSE(TriangulationOptions{}.Validate());
  EXPECT_TRUE(TriangulationOptions{.min_parallax_rad = -1}.Validate());
  EXPECT_TRUE(TriangulationOptions{.max_iterations = -1}.Validate());
}

TEST(Parallax, IsTheAngleAtThePoint) {
  EXPECT_NEAR(Parallax_rad({0, 0, 1}, {-1, 0, 0}, {1, 0, 0}), M_PI / 2, 1e-12);
  EXPECT_NEAR(Parallax_rad({0, 0, 1}, {0, 0, 0}, {0, 0, 2}), M_PI, 1e-12);
  EXPECT_NEAR(Parallax_rad({0, 0, 1e6}, {0, 0, 0}, {1, 0, 0}), 1e-6, 1e-15);
}

}  // namespace
}  // namespace vpslam
