#include "core/estimation/pose_optimizer.h"

#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

namespace vpslam {
namespace {

struct Scene {
  Camera camera;
  SE3 cam_from_world;
  PoseMeasurements measurements;
  std::vector<uint8_t> is_outlier;
};

Scene MakeScene(std::mt19937& rng, int num_points, double sigma_px, double outlier_share,
                bool planar) {
  Scene scene;
  scene.camera.width = 640;
  scene.camera.height = 480;
  scene.camera.fx = scene.camera.fy = 500;
  scene.camera.cx = 320;
  scene.camera.cy = 240;
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::normal_distribution<double> normal(0, sigma_px);
  scene.cam_from_world = SE3(ExpSo3({0.2 * uniform(rng), 0.2 * uniform(rng), 0.2 * uniform(rng)}),
                             Eigen::Vector3d(uniform(rng), uniform(rng), uniform(rng)));
  for (int i = 0; i < num_points; ++i) {
    const double depth = planar ? 3.0 : 3.0 + 1.5 * uniform(rng);
    const Eigen::Vector2d px(320 + 300 * uniform(rng), 240 + 220 * uniform(rng));
    PointMeasurement m;
    m.point_in_world = scene.cam_from_world.Inverse() * (depth * scene.camera.Unproject(px));
    m.px = px + Eigen::Vector2d(normal(rng), normal(rng));
    m.sqrt_information /= sigma_px;
    const bool outlier = i < outlier_share * num_points;
    if (outlier) m.px = {320 + 300 * uniform(rng), 240 + 220 * uniform(rng)};
    scene.measurements.points.push_back(m);
    scene.is_outlier.push_back(outlier);
  }
  return scene;
}

Vector6d Perturbation(std::mt19937& rng, double metres, double radians) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Vector6d xi;
  for (int k = 0; k < 6; ++k) xi[k] = uniform(rng) * (k < 3 ? metres : radians);
  return xi;
}

TEST(PoseOptimizer, ErrorsAgreeWithTheCovariance) {
  std::mt19937 rng(1);
  for (const bool planar : {false, true}) {
    double sum = 0;
    constexpr int kTrials = 200;
    for (int i = 0; i < kTrials; ++i) {
      const Scene scene = MakeScene(rng, 100, 1.0, 0.0, planar);
      const PoseEstimate estimate =
          OptimizePose(scene.camera, scene.measurements,
                       Retract(scene.cam_from_world, Perturbation(rng, 0.1, 0.05)), {});
      const Vector6d e = LocalCoordinates(estimate.cam_from_world, scene.cam_from_world);
      sum += e.dot(estimate.covariance.ldlt().solve(e));
    }
    // Mean of chi-square with six degrees of freedom; the gate at 95 % bends it slightly.
    EXPECT_NEAR(sum / kTrials, 6.0, 1.5) << (planar ? "plane" : "volume");
  }
}

TEST(PoseOptimizer, EdgesCountAcrossOnly) {
  std::mt19937 rng(6);
  std::uniform_real_distribution<double> angle(0, std::numbers::pi);
  std::normal_distribution<double> normal;
  constexpr int kTrials = 100;
  double aware = 0, unaware = 0, chi2 = 0;
  for (int i = 0; i < kTrials; ++i) {
    Scene scene = MakeScene(rng, 60, 1.0, 0.0, false);
    for (PointMeasurement& m : scene.measurements.points) {
      constexpr double kAlong_px = 10;
      const double edge_rad = angle(rng);
      const Eigen::Vector2d edge(std::cos(edge_rad), std::sin(edge_rad));
      m.px += kAlong_px * normal(rng) * edge;
      m.sqrt_information -= (1 - 1 / std::hypot(1, kAlong_px)) * edge * edge.transpose();
    }
    const SE3 initial = Retract(scene.cam_from_world, Perturbation(rng, 0.1, 0.05));
    const PoseEstimate estimate = OptimizePose(scene.camera, scene.measurements, initial, {});
    const Vector6d e = LocalCoordinates(estimate.cam_from_world, scene.cam_from_world);
    chi2 += e.dot(estimate.covariance.ldlt().solve(e));
    aware += e.squaredNorm();
    for (PointMeasurement& m : scene.measurements.points) {
      m.sqrt_information = Eigen::Matrix2d::Identity() / 10;
    }
    unaware +=
        LocalCoordinates(OptimizePose(scene.camera, scene.measurements, initial, {}).cam_from_world,
                         scene.cam_from_world)
            .squaredNorm();
  }
  EXPECT_NEAR(chi2 / kTrials, 6.0, 1.8);
  EXPECT_LT(std::sqrt(aware / unaware), 0.4);
}

TEST(PoseOptimizer, FindsThePoseAmongOutliers) {
  std::mt19937 rng(2);
  for (int i = 0; i < 50; ++i) {
    const Scene scene = MakeScene(rng, 150, 1.0, 0.3, false);
    const PoseEstimate estimate =
        OptimizePose(scene.camera, scene.measurements,
                     Retract(scene.cam_from_world, Perturbation(rng, 0.05, 0.02)), {});
    const Vector6d e = LocalCoordinates(estimate.cam_from_world, scene.cam_from_world);
    EXPECT_LT(e.head<3>().norm(), 0.03);
    EXPECT_LT(e.tail<3>().norm(), 0.01);
    int wrong = 0;
    for (size_t k = 0; k < scene.measurements.points.size(); ++k) {
      wrong += scene.is_outlier[k] && estimate.inliers[k];
    }
    EXPECT_LE(wrong, 2);
  }
}

TEST(PoseOptimizer, TooFewMeasurementsChangeNothing) {
  std::mt19937 rng(3);
  const Scene scene = MakeScene(rng, 2, 1.0, 0.0, false);
  const PoseEstimate estimate = OptimizePose(scene.camera, scene.measurements, SE3(), {});
  EXPECT_EQ(estimate.num_inliers, 0);
  EXPECT_EQ(estimate.cam_from_world.translation, Eigen::Vector3d::Zero());
}

TEST(PoseOptimizer, PointsBehindTheCameraAreNoInliers) {
  std::mt19937 rng(4);
  Scene scene = MakeScene(rng, 50, 1.0, 0.0, false);
  scene.measurements.points[0].point_in_world =
      scene.cam_from_world.Inverse() * Eigen::Vector3d(0, 0, -2);
  const PoseEstimate estimate =
      OptimizePose(scene.camera, scene.measurements, scene.cam_from_world, {});
  EXPECT_FALSE(estimate.inliers[0]);
  EXPECT_GT(estimate.num_inliers, 40);
}

}  // namespace
}  // namespace vpslam
