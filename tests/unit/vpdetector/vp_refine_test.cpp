#include "vpdetector/vp_refine.h"

#include <gtest/gtest.h>

#include "tests/unit/vpdetector/vp_scene.h"

namespace vpslam {
namespace {

std::vector<VpLine> ToLines(const VpScene& scene) {
  std::vector<VpLine> lines;
  for (const EdgeSegment& s : scene.segments) {
    lines.push_back(*MakeVpLine(scene.camera, s.start_px, s.end_px, s.sigma_px, 1));
  }
  return lines;
}

TEST(VpRefineTest, JacobianIsTheDerivative) {
  std::mt19937_64 rng(1);
  for (int trial = 0; trial < 1000; ++trial) {
    const Eigen::Quaterniond r = RandomRotation(rng);
    const Eigen::Vector3d normal = RandomRotation(rng) * Eigen::Vector3d::UnitX();
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(trial % 3);
    const Eigen::Vector3d analytic = ResidualJacobian(normal, r * axis);
    const double h = 1e-6;
    for (int i = 0; i < 3; ++i) {
      const Eigen::Vector3d w = h * Eigen::Vector3d::Unit(i);
      const double numeric =
          (normal.dot((ExpSo3(w) * r) * axis) - normal.dot((ExpSo3(-w) * r) * axis)) / (2 * h);
      EXPECT_NEAR(analytic[i], numeric, 1e-8);
    }
  }
}

TEST(VpLinesTest, NoiseIsTheDerivativeByTheEndPoints) {
  VpSceneOptions options;
  options.cam_from_manhattan = ExpSo3({0.3, 0.5, -0.2});
  options.sigma_px = 0;
  Camera camera = SceneCamera();
  camera.fy = 400;  // unlike fx
  const Eigen::Vector2d a(100, 350), b(420, 210);
  const double sigma_px = 1e-4;
  const VpLine line = *MakeVpLine(camera, a, b, sigma_px, 1);
  const Eigen::Vector2d along = (b - a).normalized(), across(-along.y(), along.x());
  const VpLine moved_a = *MakeVpLine(camera, a + sigma_px * across, b, sigma_px, 1);
  const VpLine moved_b = *MakeVpLine(camera, a, b + sigma_px * across, sigma_px, 1);
  std::mt19937_64 rng(2);
  for (int trial = 0; trial < 100; ++trial) {
    // For directions on the great circle, where residuals are small.
    Eigen::Vector3d d = RandomRotation(rng) * Eigen::Vector3d::UnitX();
    d = (d - line.normal * line.normal.dot(d)).normalized();
    EXPECT_NEAR(line.noise_a.dot(d), moved_a.normal.dot(d), 1e-10);
    EXPECT_NEAR(line.noise_b.dot(d), moved_b.normal.dot(d), 1e-10);
  }
}

TEST(VpRefineTest, ConvergesFromDegreesAwayAndIgnoresOutliers) {
  std::mt19937_64 rng(4);
  for (uint64_t trial = 0; trial < 100; ++trial) {
    VpSceneOptions options;
    options.cam_from_manhattan = RandomRotation(rng);
    options.outliers = 20;
    options.seed = trial;
    const VpScene scene = MakeVpScene(options);
    const Eigen::Vector3d away = RandomRotation(rng) * Eigen::Vector3d::UnitX() * 0.02;
    const ManhattanFit fit = RefineManhattan(
        ToLines(scene), (ExpSo3(away) * options.cam_from_manhattan).toRotationMatrix(), VpModel());
    EXPECT_LT(RotationErrorSceneDeg(fit.cam_from_manhattan, options.cam_from_manhattan), 0.6);
  }
}

TEST(VpRefineTest, ExactLinesGiveTheExactRotation) {
  VpSceneOptions options;
  options.cam_from_manhattan = ExpSo3({-0.4, 0.3, 0.2});
  options.sigma_px = 0;
  const VpScene scene = MakeVpScene(options);
  const Eigen::Matrix3d start =
      (ExpSo3({0.05, 0.03, -0.04}) * options.cam_from_manhattan).toRotationMatrix();
  const ManhattanFit fit = FitLabelledLines(ToLines(scene), scene.truth_labels, start, VpModel());
  EXPECT_LT(RotationErrorSceneDeg(fit.cam_from_manhattan, options.cam_from_manhattan), 1e-6);
}

TEST(VpRefineTest, AnAxisAloneLeavesItsOwnTurnOpen) {
  VpSceneOptions options;
  options.cam_from_manhattan = ExpSo3({-0.4, 0.3, 0.2});
  options.axis_lines[0] = options.axis_lines[2] = 0;
  const VpScene scene = MakeVpScene(options);
  const Eigen::Matrix3d truth = options.cam_from_manhattan.toRotationMatrix();
  const ManhattanFit fit = FitLabelledLines(ToLines(scene), scene.truth_labels, truth, VpModel());
  const Eigen::Vector3d axis = fit.cam_from_manhattan.col(1);
  EXPECT_GT(std::sqrt(axis.dot(fit.covariance_rad2 * axis)), 1.0);
  const Eigen::Vector3d other = fit.cam_from_manhattan.col(0);
  EXPECT_LT(std::sqrt(other.dot(fit.covariance_rad2 * other)), 0.01);
}

TEST(VpLinesTest, FragmentsOfOneLineAreOneWitness) {
  const std::vector<Eigen::Vector2d> starts{{0, 0}, {200, 1}, {0, 50}, {320, -1}};
  const std::vector<Eigen::Vector2d> ends{{100, 0}, {300, 1}, {90, 58}, {350, 1}};
  const std::vector<int32_t> group = GroupByInfiniteLine(starts, ends, 3.0);
  EXPECT_EQ(group[0], 0);
  EXPECT_EQ(group[1], 0);
  EXPECT_EQ(group[2], 2);
  EXPECT_EQ(group[3], 0);
  EXPECT_TRUE(GroupByInfiniteLine({}, {}, 3.0).empty());
}

}  // namespace
}  // namespace vpslam
