#include "core/estimation/linear_translation.h"

#include <gtest/gtest.h>

namespace vpslam {
namespace {

struct SceneOptions {
  int num_points = 100;
  double sigma_px = 1;
  double near = 1, far = 10;
  double outlier_share = 0;
  double half_width_px = 300;  ///< of the part of the image that shows points
};

struct Scene {
  Camera camera;
  SE3 cam_from_world;
  std::vector<PointMeasurement> points;
};

class LinearTranslation : public testing::Test {
 protected:
  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng_);
  }
  Scene Make(const SceneOptions& options) {
    Scene scene;
    scene.camera.width = 640;
    scene.camera.height = 480;
    scene.camera.fx = 500;
    scene.camera.fy = 480;
    scene.camera.cx = 320;
    scene.camera.cy = 240;
    const Eigen::Quaterniond rotation = ExpSo3({Uniform(-1, 1), Uniform(-1, 1), Uniform(-1, 1)});
    scene.cam_from_world =
        SE3(rotation, Eigen::Vector3d(Uniform(-2, 2), Uniform(-2, 2), Uniform(-2, 2)));
    std::normal_distribution<double> normal(0, 1);
    const auto pixel = [&] {
      const double u = Uniform(-1, 1), v = Uniform(-1, 1);
      return Eigen::Vector2d(320 + options.half_width_px * u,
                             240 + 0.7 * options.half_width_px * v);
    };
    for (int i = 0; i < options.num_points; ++i) {
      const Eigen::Vector2d px = pixel();
      const double depth = Uniform(options.near, options.far);
      const double u = normal(rng_), v = normal(rng_);
      PointMeasurement m;
      m.point_in_world = scene.cam_from_world.Inverse() * (depth * scene.camera.Unproject(px));
      m.px = px + options.sigma_px * Eigen::Vector2d(u, v);
      if (i < options.outlier_share * options.num_points) m.px = pixel();
      if (options.sigma_px > 0) m.sqrt_information /= options.sigma_px;
      scene.points.push_back(m);
    }
    return scene;
  }
  std::optional<Eigen::Vector3d> Estimate(const Scene& scene, TranslationWeights weights,
                                          int min_inliers = 10) {
    std::mt19937_64 rng(7);
    return EstimateTranslation(scene.camera, scene.points, scene.cam_from_world.rotation, weights,
                               min_inliers, rng);
  }

  std::mt19937_64 rng_{1};
};

constexpr TranslationWeights kBoth[] = {TranslationWeights::kNone,
                                        TranslationWeights::kInverseDepth};

TEST_F(LinearTranslation, Eq12IsExactWithoutNoise) {
  for (int trial = 0; trial < 50; ++trial) {
    // Also of a plane parallel to the image.
    const Scene scene = Make({.sigma_px = 0, .far = trial % 2 ? 10.0 : 1.0});
    for (const auto weights : kBoth) {
      const auto t = Estimate(scene, weights);
      ASSERT_TRUE(t);
      EXPECT_NEAR((*t - scene.cam_from_world.translation).norm(), 0, 1e-9);
    }
  }
}

TEST_F(LinearTranslation, WeightsByInverseDepthAreBetterWhereDepthsVary) {
  constexpr int kTrials = 200;
  double none = 0, weighted = 0;
  int better = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Scene scene = Make({});
    const auto error = [&](TranslationWeights weights) {
      return (*Estimate(scene, weights) - scene.cam_from_world.translation).norm();
    };
    const double a = error(TranslationWeights::kNone), b = error(TranslationWeights::kInverseDepth);
    none += a * a;
    weighted += b * b;
    better += b < a;
  }
  // Fair coins would show more than 130 heads of 200 once in a hundred thousand times.
  EXPECT_GT(better, 130);
  EXPECT_LT(std::sqrt(weighted / none), 0.7);
}

TEST_F(LinearTranslation, WeightedErrorsAgreeWithTheNoise) {
  constexpr int kTrials = 200;
  double sum = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Scene scene = Make({});
    const Eigen::Vector3d error =
        *Estimate(scene, TranslationWeights::kInverseDepth) - scene.cam_from_world.translation;
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    for (const PointMeasurement& m : scene.points) {
      const Eigen::Vector3d x = scene.cam_from_world * m.point_in_world;
      Eigen::Matrix<double, 2, 3> a;
      a << -1, 0, x.x() / x.z(), 0, -1, x.y() / x.z();
      a.row(0) *= scene.camera.fx / x.z();
      a.row(1) *= scene.camera.fy / x.z();
      a = m.sqrt_information * a;
      information += a.transpose() * a;
    }
    sum += error.dot(information * error);
  }
  // Chi-square with three degrees of freedom has 3; these, inliers of RANSAC, have 4.6.
  EXPECT_GT(sum / kTrials, 2.4);
  EXPECT_LT(sum / kTrials, 5.8);
}

TEST_F(LinearTranslation, FindsItAmongOutliers) {
  for (int trial = 0; trial < 50; ++trial) {
    const Scene scene = Make({.outlier_share = 0.4});
    for (const auto weights : kBoth) {
      const auto t = Estimate(scene, weights);
      ASSERT_TRUE(t);
      // Sixty points of 1 px, 1 to 10 away: 0.002 across each, and thrice that along z.
      EXPECT_LT((*t - scene.cam_from_world.translation).norm(), 0.06);
    }
  }
}

TEST_F(LinearTranslation, FewInliersAreNone) {
  const Scene all_wrong = Make({.outlier_share = 1});
  const Scene few = Make({.num_points = 9});
  const Scene enough = Make({.num_points = 12, .sigma_px = 1e-3});
  for (const auto weights : kBoth) {
    EXPECT_FALSE(Estimate(all_wrong, weights, 20));
    EXPECT_FALSE(Estimate(few, weights, 10));
    EXPECT_FALSE(Estimate({}, weights, 0));
    EXPECT_FALSE(Estimate(Make({.num_points = 1}), weights, 0));
    EXPECT_TRUE(Estimate(enough, weights, 8));
  }
}

TEST_F(LinearTranslation, PointsOnOneRayLeaveTheDistanceOpen) {
  for (const double sigma_px : {0.0, 1.0}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Scene scene = Make({.sigma_px = sigma_px, .half_width_px = 0});
      for (const auto weights : kBoth) EXPECT_FALSE(Estimate(scene, weights)) << sigma_px;
    }
  }
}

TEST_F(LinearTranslation, SameSeedSameResult) {
  const Scene scene = Make({.outlier_share = 0.3});
  EXPECT_EQ(*Estimate(scene, TranslationWeights::kNone),
            *Estimate(scene, TranslationWeights::kNone));
}

}  // namespace
}  // namespace vpslam
