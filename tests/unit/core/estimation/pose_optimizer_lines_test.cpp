#include <numbers>
#include <random>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "core/estimation/line_residual.h"
#include "core/estimation/pose_optimizer.h"

namespace vpslam {
namespace {

struct SceneOptions {
  int num_points = 0;
  int num_lines = 60;
  double sigma_px = 1.0;
  double outlier_share = 0;       ///< of lines
  double rotation_sigma_rad = 0;  ///< 0: not measured
};

struct Scene {
  Camera camera;
  SE3 cam_from_world;
  PoseMeasurements measurements;
};

class PoseFromLines : public testing::Test {
 protected:
  double Uniform() { return uniform_(rng_); }
  Eigen::Vector3d Normal(double sigma) {
    const double x = normal_(rng_), y = normal_(rng_), z = normal_(rng_);
    return sigma * Eigen::Vector3d(x, y, z);
  }
  Eigen::Vector2d Pixel() {
    const double u = 300 * Uniform(), v = 220 * Uniform();
    return {320 + u, 240 + v};
  }
  /// `px` at a depth of 1.5 to 4.5, in world.
  Eigen::Vector3d Behind(const Scene& scene, const Eigen::Vector2d& px) {
    return scene.cam_from_world.Inverse() * ((3 + 1.5 * Uniform()) * scene.camera.Unproject(px));
  }

  Scene Make(const SceneOptions& options) {
    Scene scene;
    scene.camera.width = 640;
    scene.camera.height = 480;
    scene.camera.fx = scene.camera.fy = 500;
    scene.camera.cx = 320;
    scene.camera.cy = 240;
    const Eigen::Quaterniond rotation = ExpSo3(Normal(0.2));
    scene.cam_from_world = SE3(rotation, Normal(0.5));
    const double inv_sigma2 = 1 / (options.sigma_px * options.sigma_px);
    for (int i = 0; i < options.num_points; ++i) {
      const Eigen::Vector2d px = Pixel();
      const Eigen::Vector3d x = Behind(scene, px);
      scene.measurements.points.push_back({x, px + Normal(options.sigma_px).head<2>(),
                                           Eigen::Matrix2d::Identity() / options.sigma_px});
    }
    for (int i = 0; i < options.num_lines; ++i) {
      Eigen::Vector2d a = Pixel(), b = Pixel();
      while ((a - b).norm() < 50) b = Pixel();
      LineMeasurement m;
      m.start_in_world = Behind(scene, a);
      m.end_in_world = Behind(scene, b);
      m.inv_sigma2 = inv_sigma2;
      if (i < options.outlier_share * options.num_lines) {
        m.start_px = Pixel();
        m.end_px = Pixel();
      } else {
        // Its ends are anywhere on the line.
        const double from = 0.2 * Uniform(), to = 1 + 0.2 * Uniform();
        const Eigen::Vector2d along = b - a;
        m.start_px = a + from * along + Normal(options.sigma_px).head<2>();
        m.end_px = a + to * along + Normal(options.sigma_px).head<2>();
      }
      scene.measurements.lines.push_back(m);
    }
    if (options.rotation_sigma_rad > 0) {
      const double sigma_rad = options.rotation_sigma_rad;
      scene.measurements.rotation = {ExpSo3(Normal(sigma_rad)) * rotation,
                                     Eigen::Matrix3d::Identity() / (sigma_rad * sigma_rad)};
    }
    return scene;
  }
  SE3 Nearby(const SE3& pose, double sigma, double sigma_rad) {
    Vector6d xi;
    xi.head<3>() = Normal(sigma);
    xi.tail<3>() = Normal(sigma_rad);
    return Retract(pose, xi);
  }
  double MeanChi2(const SceneOptions& options) {
    constexpr int kTrials = 200;
    double sum = 0;
    for (int i = 0; i < kTrials; ++i) {
      const Scene scene = Make(options);
      const PoseEstimate estimate = OptimizePose(scene.camera, scene.measurements,
                                                 Nearby(scene.cam_from_world, 0.05, 0.02), {});
      const Vector6d e = LocalCoordinates(estimate.cam_from_world, scene.cam_from_world);
      sum += e.dot(estimate.covariance.ldlt().solve(e));
    }
    return sum / kTrials;
  }

  std::mt19937 rng_{1};
  std::uniform_real_distribution<double> uniform_{-1, 1};
  std::normal_distribution<double> normal_{0, 1};
};

// The mean of chi-square with six degrees of freedom; the gate at 95 % bends it slightly, and 200
// trials leave it a standard deviation of 0.25.
TEST_F(PoseFromLines, ErrorsAgreeWithTheCovariance) { EXPECT_NEAR(MeanChi2({}), 6, 1.5); }
TEST_F(PoseFromLines, ErrorsAgreeWithTheCovarianceWithPointsToo) {
  EXPECT_NEAR(MeanChi2({.num_points = 40, .num_lines = 20}), 6, 1.5);
}
TEST_F(PoseFromLines, ErrorsAgreeWithTheCovarianceWithAMeasuredRotation) {
  // It says more about the rotation than a few lines and points do.
  EXPECT_NEAR(MeanChi2({.num_points = 10, .num_lines = 10, .rotation_sigma_rad = 5e-4}), 6, 1.6);
}

TEST_F(PoseFromLines, LinesAndRotationMakeThePoseBetter) {
  double without = 0, with_lines = 0, with_rotation = 0;
  for (int i = 0; i < 100; ++i) {
    Scene scene = Make({.num_points = 30, .num_lines = 30, .rotation_sigma_rad = 1e-3});
    const auto error2 = [&] {
      return LocalCoordinates(
                 OptimizePose(scene.camera, scene.measurements, scene.cam_from_world, {})
                     .cam_from_world,
                 scene.cam_from_world)
          .squaredNorm();
    };
    with_rotation += error2();
    scene.measurements.rotation.reset();
    with_lines += error2();
    scene.measurements.lines.clear();
    without += error2();
  }
  EXPECT_LT(with_lines, 0.8 * without);
  EXPECT_LT(with_rotation, 0.8 * with_lines);
}

TEST_F(PoseFromLines, OneStepLeavesTheSquareOfTheError) {
  // Without noise Gauss-Newton with the right derivatives converges quadratically.
  for (const bool only_rotation_helps : {false, true}) {
    for (int i = 0; i < 50; ++i) {
      Scene scene = Make({.num_lines = only_rotation_helps ? 3 : 40, .sigma_px = 1e-6});
      for (auto& m : scene.measurements.lines) m.inv_sigma2 = 1;
      if (only_rotation_helps) {
        scene.measurements.rotation = {scene.cam_from_world.rotation,
                                       1e6 * Eigen::Matrix3d::Identity()};
      }
      const SE3 initial = Nearby(scene.cam_from_world, 5e-4, 2e-4);
      const double before = LocalCoordinates(initial, scene.cam_from_world).norm();
      const PoseEstimate estimate = OptimizePose(scene.camera, scene.measurements, initial,
                                                 {.rounds = 1, .iterations_per_round = 1});
      const double after = LocalCoordinates(estimate.cam_from_world, scene.cam_from_world).norm();
      // Three lines may be ill-conditioned: then the damping shows.
      EXPECT_LT(after, only_rotation_helps ? 0.1 * before : 0.02 * before) << i;
    }
  }
}

TEST_F(PoseFromLines, FindsThePoseAmongOutliers) {
  for (int i = 0; i < 30; ++i) {
    const Scene scene = Make({.num_points = 20, .outlier_share = 0.3});
    const PoseEstimate estimate = OptimizePose(scene.camera, scene.measurements,
                                               Nearby(scene.cam_from_world, 0.03, 0.01), {});
    const Vector6d e = LocalCoordinates(estimate.cam_from_world, scene.cam_from_world);
    EXPECT_LT(e.dot(estimate.covariance.ldlt().solve(e)), 40) << i;
    int wrong = 0, right = 0;
    for (size_t k = 0; k < scene.measurements.lines.size(); ++k) {
      (k < 18 ? wrong : right) += estimate.line_inliers[k];
    }
    EXPECT_LE(wrong, 1);
    EXPECT_GE(right, 32) << "of 42, of which one in twenty fails the gate";
    EXPECT_EQ(estimate.num_line_inliers, wrong + right);
  }
}

TEST_F(PoseFromLines, AWrongRotationPullsNoHarderTheMoreItIsWrong) {
  for (int i = 0; i < 20; ++i) {
    Scene scene = Make({.num_points = 60, .num_lines = 30, .rotation_sigma_rad = 1e-3});
    const auto optimize = [&] {
      return OptimizePose(scene.camera, scene.measurements, scene.cam_from_world, {})
          .cam_from_world;
    };
    const auto with_error = [&](double error_rad) {
      scene.measurements.rotation->cam_from_world =
          ExpSo3({error_rad, 0, 0}) * scene.cam_from_world.rotation;
      return optimize();
    };
    const SE3 wrong = with_error(0.05), very_wrong = with_error(0.15);
    scene.measurements.rotation.reset();
    EXPECT_LT(LocalCoordinates(wrong, optimize()).norm(), 0.01);
    EXPECT_LT(LocalCoordinates(wrong, very_wrong).norm(), 1e-3);
  }
}

TEST_F(PoseFromLines, AMeasuredRotationHoldsAPoseThatDrifts) {
  // Points that say, all together, that the camera has turned by two degrees more.
  const double turn_rad = 2 * std::numbers::pi / 180;
  double error_rad = 0, error_without_rad = 0;
  for (int i = 0; i < 20; ++i) {
    Scene scene = Make({.num_points = 20, .num_lines = 0, .rotation_sigma_rad = 2e-4});
    const SE3 turned =
        SE3(ExpSo3({0, turn_rad, 0}), Eigen::Vector3d::Zero()) * scene.cam_from_world;
    for (PointMeasurement& m : scene.measurements.points) {
      m.px = scene.camera.Project(turned * m.point_in_world);
    }
    const auto error = [&] {
      return AngleBetween_rad(
          OptimizePose(scene.camera, scene.measurements, turned, {}).cam_from_world.rotation,
          scene.cam_from_world.rotation);
    };
    error_rad += error() / 20;
    scene.measurements.rotation.reset();
    error_without_rad += error() / 20;
  }
  EXPECT_NEAR(error_without_rad, turn_rad, 1e-4);
  EXPECT_LT(error_rad, 0.95 * turn_rad);
}

TEST_F(PoseFromLines, LinesThatCannotBeSeenAreNoInliers) {
  Scene scene = Make({.num_points = 30, .num_lines = 20});
  const SE3 world_from_cam = scene.cam_from_world.Inverse();
  auto& lines = scene.measurements.lines;
  // Behind the camera, where it has the same image; and through the camera's centre.
  lines[0].start_in_world = world_from_cam * -(scene.cam_from_world * lines[0].start_in_world);
  lines[0].end_in_world = world_from_cam * -(scene.cam_from_world * lines[0].end_in_world);
  lines[1].start_in_world = world_from_cam * Eigen::Vector3d(0, 0, 0);
  lines[1].end_in_world = world_from_cam * Eigen::Vector3d(0.2, 0, 1);
  const PoseEstimate estimate =
      OptimizePose(scene.camera, scene.measurements, scene.cam_from_world, {});
  EXPECT_FALSE(estimate.line_inliers[0]);
  EXPECT_FALSE(estimate.line_inliers[1]);
  EXPECT_GE(estimate.num_line_inliers, 14);
  EXPECT_TRUE(estimate.covariance.allFinite());
}

TEST_F(PoseFromLines, ParallelLinesLeaveTheShiftAlongThemWhereItWas) {
  Scene scene = Make({.num_lines = 0, .sigma_px = 1e-6});
  for (int i = 0; i < 20; ++i) {
    const Eigen::Vector3d start = 2 * Eigen::Vector3d(Uniform(), 0.5 * Uniform(), 2 + Uniform());
    const Eigen::Vector3d end = start + Eigen::Vector3d::UnitX();
    const SE3 world_from_cam = scene.cam_from_world.Inverse();
    scene.measurements.lines.push_back({world_from_cam * start, world_from_cam * end,
                                        scene.camera.Project(start), scene.camera.Project(end), 1});
  }
  Vector6d off;
  off << 0.05, 0.002, -0.002, 0, 0, 0;
  const PoseEstimate estimate =
      OptimizePose(scene.camera, scene.measurements, Retract(scene.cam_from_world, off), {});
  const Vector6d e = LocalCoordinates(scene.cam_from_world, estimate.cam_from_world);
  EXPECT_NEAR(e[0], 0.05, 5e-3) << "nothing observes it";
  EXPECT_LT(e.tail<5>().norm(), 1e-4);
  EXPECT_GT(estimate.covariance(0, 0), 1) << "and the covariance says so";
}

TEST_F(PoseFromLines, TwoLinesChangeNothing) {
  const Scene scene = Make({.num_lines = 2});
  const PoseEstimate estimate = OptimizePose(scene.camera, scene.measurements, SE3(), {});
  EXPECT_EQ(estimate.num_line_inliers, 0);
  EXPECT_EQ(estimate.cam_from_world.translation, Eigen::Vector3d::Zero());
  EXPECT_EQ(estimate.line_inliers, std::vector<uint8_t>(2, 0));
}

}  // namespace
}  // namespace vpslam
