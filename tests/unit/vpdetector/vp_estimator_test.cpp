#include "vpdetector/vp_estimator.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/geometry/sphere.h"
#include "tests/unit/vpdetector/vp_scene.h"

namespace vpslam {
namespace {

double Median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  return v[v.size() / 2];
}

VpOptions WithMethod(VpMethod method) {
  VpOptions options;
  options.method = method;
  return options;
}

TEST(VpEstimatorTest, FindsManyRotationsAmongNoiseAndOutliers) {
  std::mt19937_64 rng(3);
  for (const VpMethod method : {VpMethod::kThreeLine, VpMethod::kTwoLineGrid}) {
    std::vector<double> errors;
    for (uint64_t trial = 0; trial < 100; ++trial) {
      VpSceneOptions scene_options;
      scene_options.cam_from_manhattan = RandomRotation(rng);
      scene_options.outliers = 30;
      scene_options.sigma_px = 0.5;
      scene_options.seed = trial;
      const VpScene scene = MakeVpScene(scene_options);
      const VpEstimate vps =
          EstimateVanishingPoints(scene.segments, scene.camera, WithMethod(method));
      errors.push_back(
          RotationErrorSceneDeg(vps.cam_from_manhattan, scene_options.cam_from_manhattan));
      EXPECT_EQ(vps.state, ManhattanState::kThree) << Name(method) << " trial " << trial;
    }
    EXPECT_LT(Median(errors), method == VpMethod::kThreeLine ? 0.2 : 0.5) << Name(method);
    EXPECT_LT(*std::max_element(errors.begin(), errors.end()),
              method == VpMethod::kThreeLine ? 1.5 : 5.0)
        << Name(method);
  }
}

TEST(VpEstimatorTest, LabelsAgreeWithTruth) {
  VpSceneOptions scene_options;
  scene_options.cam_from_manhattan = ExpSo3({0.2, -0.3, 0.1});
  const VpScene scene = MakeVpScene(scene_options);
  const VpEstimate vps = EstimateVanishingPoints(scene.segments, scene.camera, VpOptions());
  ASSERT_EQ(vps.labels.size(), scene.segments.size());
  // So small a rotation leaves the axes in their order.
  int right = 0;
  for (size_t i = 0; i < vps.labels.size(); ++i) right += vps.labels[i] == scene.truth_labels[i];
  EXPECT_GE(right, 57);  // of 60: a few lines point to two vanishing points at once
}

TEST(VpEstimatorTest, FrontoParallelViewsAreNoWorse) {
  // Vanishing points at infinity and in the middle of the image: the borders of the polar grid.
  for (const VpMethod method : {VpMethod::kThreeLine, VpMethod::kTwoLineGrid}) {
    std::vector<double> errors;
    for (uint64_t trial = 0; trial < 50; ++trial) {
      VpSceneOptions scene_options;
      scene_options.cam_from_manhattan =
          ExpSo3({0.01 * std::sin(trial), 0.01 * std::cos(3.0 * trial), 0.005});
      scene_options.outliers = 15;
      scene_options.seed = 1000 + trial;
      const VpScene scene = MakeVpScene(scene_options);
      const VpEstimate vps =
          EstimateVanishingPoints(scene.segments, scene.camera, WithMethod(method));
      errors.push_back(
          RotationErrorSceneDeg(vps.cam_from_manhattan, scene_options.cam_from_manhattan));
    }
    EXPECT_LT(Median(errors), 0.3) << Name(method);
    EXPECT_LT(*std::max_element(errors.begin(), errors.end()), 2.0) << Name(method);
  }
}

TEST(VpEstimatorTest, SaysTwoWhenOneAxisIsUnseen) {
  for (int unseen = 0; unseen < 3; ++unseen) {
    VpSceneOptions scene_options;
    scene_options.cam_from_manhattan = ExpSo3({0.3, -0.4, 0.05});
    scene_options.axis_lines[unseen] = 0;
    scene_options.outliers = 5;
    const VpScene scene = MakeVpScene(scene_options);
    const VpEstimate vps = EstimateVanishingPoints(scene.segments, scene.camera, VpOptions());
    EXPECT_EQ(vps.state, ManhattanState::kTwo) << unseen;
    EXPECT_LT(RotationErrorSceneDeg(vps.cam_from_manhattan, scene_options.cam_from_manhattan), 0.5);
    ASSERT_GE(vps.vanishing_points.size(), 3u);
    EXPECT_EQ(vps.vanishing_points[static_cast<size_t>(unseen)].support, 0);
    EXPECT_EQ(std::count(vps.labels.begin(), vps.labels.end(), unseen), 0);
  }
}

TEST(VpEstimatorTest, SaysNoneForClutterAndForOneDirection) {
  int not_none = 0;
  for (uint64_t seed = 0; seed < 50; ++seed) {
    VpSceneOptions clutter;
    for (int& n : clutter.axis_lines) n = 0;
    clutter.outliers = 20 + 4 * static_cast<int>(seed);
    clutter.seed = seed;
    const VpScene scene = MakeVpScene(clutter);
    const VpEstimate vps = EstimateVanishingPoints(scene.segments, scene.camera, VpOptions());
    not_none += vps.state != ManhattanState::kNone;
  }
  EXPECT_LE(not_none, 3);

  VpSceneOptions one;
  one.cam_from_manhattan = ExpSo3({0.3, -0.4, 0.05});
  one.axis_lines[0] = one.axis_lines[2] = 0;
  const VpScene scene = MakeVpScene(one);
  const VpEstimate vps = EstimateVanishingPoints(scene.segments, scene.camera, VpOptions());
  EXPECT_EQ(vps.state, ManhattanState::kNone);
  // The one direction is reported all the same.
  ASSERT_FALSE(vps.vanishing_points.empty());
  EXPECT_LT(AxisAngle_rad(vps.vanishing_points[0].direction_in_cam,
                          one.cam_from_manhattan.toRotationMatrix().col(1)),
            0.01);
}

TEST(VpEstimatorTest, ReportsFurtherDirections) {
  VpSceneOptions scene_options;
  scene_options.cam_from_manhattan = ExpSo3({0.2, -0.5, 0.1});
  VpScene scene = MakeVpScene(scene_options);
  // A building turned by 35 degrees about the vertical axis adds one more direction.
  VpSceneOptions turned = scene_options;
  turned.cam_from_manhattan = scene_options.cam_from_manhattan * ExpSo3({0, 0.61, 0});
  turned.axis_lines[0] = 12;
  turned.axis_lines[1] = turned.axis_lines[2] = 0;
  turned.seed = 2;
  const VpScene more = MakeVpScene(turned);
  scene.segments.insert(scene.segments.end(), more.segments.begin(), more.segments.end());
  const VpEstimate vps = EstimateVanishingPoints(scene.segments, scene.camera, VpOptions());
  ASSERT_EQ(vps.state, ManhattanState::kThree);
  ASSERT_GE(vps.vanishing_points.size(), 4u);
  const VanishingPoint& further = vps.vanishing_points[3];
  EXPECT_GE(further.support, 9);
  EXPECT_LT(
      AxisAngle_rad(further.direction_in_cam, turned.cam_from_manhattan.toRotationMatrix().col(0)),
      0.015);
  EXPECT_GT(further.covariance_rad2.determinant(), 0);
}

// Normalised error squared, averaged: between 0.5 and 2 times its dimension, for well and badly
// built worlds alike.
TEST(VpEstimatorTest, CovarianceIsHonest) {
  struct Case {
    double sigma_px, world_sigma_deg;
    int unseen;
  };
  std::mt19937_64 rng(11);
  for (const Case& c : {Case{0.3, 0.0, -1}, Case{0.3, 0.5, -1}, Case{1.0, 0.3, -1},
                        Case{0.5, 0.3, 0}, Case{0.5, 0.3, 2}}) {
    double sum = 0, axis_sum = 0;
    int count = 0;
    for (uint64_t trial = 0; trial < 150; ++trial) {
      VpSceneOptions scene_options;
      scene_options.cam_from_manhattan = RandomRotation(rng);
      scene_options.sigma_px = c.sigma_px;
      scene_options.world_sigma_deg = c.world_sigma_deg;
      if (c.unseen >= 0) scene_options.axis_lines[c.unseen] = 0;
      scene_options.outliers = 10;
      scene_options.seed = trial;
      const VpScene scene = MakeVpScene(scene_options);
      const VpEstimate vps = EstimateVanishingPoints(scene.segments, scene.camera, VpOptions());
      if (vps.state == ManhattanState::kNone) continue;
      const Eigen::Vector3d error = RotationErrorVector(
          vps.cam_from_manhattan, scene_options.cam_from_manhattan.toRotationMatrix());
      sum += error.dot(vps.covariance_rad2.inverse() * error);
      // The first axis alone, in its tangent plane.
      const VanishingPoint& vp = vps.vanishing_points[0];
      const Eigen::Vector2d tangent =
          TangentBasis(vp.direction_in_cam).transpose() * error.cross(vp.direction_in_cam);
      axis_sum += tangent.dot(vp.covariance_rad2.inverse() * tangent);
      ++count;
    }
    ASSERT_GT(count, 120);
    const double nees = sum / count;
    EXPECT_GT(nees, 0.5 * 3) << c.sigma_px << " px, " << c.world_sigma_deg << " deg";
    EXPECT_LT(nees, 2.0 * 3) << c.sigma_px << " px, " << c.world_sigma_deg << " deg";
    EXPECT_GT(axis_sum / count, 0.5 * 2);
    EXPECT_LT(axis_sum / count, 2.0 * 2);
  }
}

TEST(VpEstimatorTest, DependsOnItsInputAlone) {
  VpSceneOptions scene_options;
  scene_options.cam_from_manhattan = ExpSo3({0.2, -0.5, 0.1});
  scene_options.outliers = 40;
  const VpScene scene = MakeVpScene(scene_options);
  scene_options.seed = 77;
  const VpScene other = MakeVpScene(scene_options);
  for (const VpMethod method : {VpMethod::kThreeLine, VpMethod::kTwoLineGrid}) {
    const VpOptions options = WithMethod(method);
    const VpEstimate first = EstimateVanishingPoints(scene.segments, scene.camera, options);
    EstimateVanishingPoints(other.segments, other.camera, options);
    const VpEstimate again = EstimateVanishingPoints(scene.segments, scene.camera, options);
    EXPECT_EQ(first.cam_from_manhattan, again.cam_from_manhattan);
    EXPECT_EQ(first.covariance_rad2, again.covariance_rad2);
    EXPECT_EQ(first.labels, again.labels);
  }
}

TEST(VpEstimatorTest, SurvivesNothingAndNextToNothing) {
  const Camera camera = SceneCamera();
  for (const VpMethod method :
       {VpMethod::kThreeLine, VpMethod::kTwoLineGrid, VpMethod::kTwoLineGridRaw}) {
    for (int lines = 0; lines < 6; ++lines) {
      for (const bool all_alike : {false, true}) {
        std::vector<EdgeSegment> segments;
        for (int i = 0; i < lines; ++i) {
          EdgeSegment s;
          s.start_px = {100, 100.0 + (all_alike ? 0 : 20 * i)};
          s.end_px = {200, 110};
          s.sigma_px = 0.2;
          segments.push_back(s);
        }
        const VpEstimate vps = EstimateVanishingPoints(segments, camera, WithMethod(method));
        EXPECT_EQ(vps.state, ManhattanState::kNone);
        EXPECT_TRUE(vps.cam_from_manhattan.allFinite());
        EXPECT_TRUE(vps.covariance_rad2.allFinite());
        EXPECT_NEAR(vps.cam_from_manhattan.determinant(), 1, 1e-9);
        EXPECT_EQ(vps.labels.size(), segments.size());
      }
    }
  }
}

TEST(VpEstimatorTest, AxesComeInTheOrderOfTheCamera) {
  std::mt19937_64 rng(5);
  for (uint64_t trial = 0; trial < 20; ++trial) {
    VpSceneOptions scene_options;
    scene_options.cam_from_manhattan = RandomRotation(rng);
    const VpScene scene = MakeVpScene(scene_options);
    const Eigen::Matrix3d r =
        EstimateVanishingPoints(scene.segments, scene.camera, VpOptions()).cam_from_manhattan;
    EXPECT_NEAR(r.determinant(), 1, 1e-9);
    // No turn of the axes among themselves by a quarter brings them closer.
    for (int axis = 0; axis < 3; ++axis) {
      for (const double quarter : {-0.5, 0.5}) {
        const Eigen::Quaterniond turn =
            ExpSo3(quarter * std::numbers::pi * Eigen::Vector3d::Unit(axis));
        EXPECT_GE(r.trace() + 1e-9, (r * turn.toRotationMatrix()).trace());
      }
    }
  }
}

TEST(VpOptionsTest, RefusesNonsense) {
  EXPECT_FALSE(VpOptions().Validate());
  VpOptions options;
  options.model.world_sigma_deg = 0;
  EXPECT_TRUE(options.Validate());
  options = VpOptions();
  options.ransac.num_hypotheses = 0;
  EXPECT_TRUE(options.Validate());
  options = VpOptions();
  options.min_length_px = std::nan("");
  EXPECT_TRUE(options.Validate());
}

}  // namespace
}  // namespace vpslam
