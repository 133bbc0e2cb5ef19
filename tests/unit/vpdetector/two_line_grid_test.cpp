#include "vpdetector/two_line_grid.h"

#include <algorithm>

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

// Without the way over equator, pole and meridian, vanishing points at infinity lose a part of
// their votes: views straight at a wall were the worst of all.
TEST(TwoLineGridTest, BordersOfTheGridCostNothing) {
  const auto median_error = [](const Eigen::Vector3d& base, double spread) {
    std::vector<double> errors;
    for (uint64_t trial = 0; trial < 60; ++trial) {
      std::mt19937_64 rng(trial);
      VpSceneOptions options;
      options.cam_from_manhattan =
          ExpSo3(base) * ExpSo3(spread * (RandomRotation(rng) * Eigen::Vector3d::UnitX()));
      options.outliers = 15;
      options.seed = trial;
      const auto found = SearchTwoLineGrid(ToLines(MakeVpScene(options)), TwoLineGridOptions());
      errors.push_back(
          RotationErrorSceneDeg(found->cam_from_manhattan, options.cam_from_manhattan));
    }
    std::sort(errors.begin(), errors.end());
    EXPECT_LT(errors[57], 3.0);
    return errors[30];
  };
  const double general = median_error({0.35, -0.5, 0.2}, 0.1);
  const double frontal = median_error({0, 0, 0}, 0.01);
  EXPECT_LT(general, 1.2);  // the grid's cells are a degree wide
  EXPECT_LT(frontal, 1.2);
}

TEST(TwoLineGridTest, LabelsLiePointingToTheirAxis) {
  VpSceneOptions options;
  options.cam_from_manhattan = ExpSo3({0.35, -0.5, 0.2});
  options.outliers = 30;
  const VpScene scene = MakeVpScene(options);
  const auto found = SearchTwoLineGrid(ToLines(scene), TwoLineGridOptions());
  ASSERT_TRUE(found);
  int labelled = 0, false_labels = 0;
  for (size_t i = 0; i < found->labels.size(); ++i) {
    if (scene.truth_labels[i] >= 0)
      labelled += found->labels[i] >= 0;
    else
      false_labels += found->labels[i] >= 0;
  }
  EXPECT_GE(labelled, 55);      // of 60
  EXPECT_LE(false_labels, 12);  // of 30, each with a chance of 3 x 12 / 180
}

TEST(TwoLineGridTest, NeedsThreeLines) {
  VpSceneOptions options;
  const std::vector<VpLine> lines = ToLines(MakeVpScene(options));
  EXPECT_FALSE(SearchTwoLineGrid({}, TwoLineGridOptions()));
  EXPECT_FALSE(SearchTwoLineGrid({lines[0], lines[1]}, TwoLineGridOptions()));
  EXPECT_FALSE(SearchTwoLineGrid({lines[0], lines[0], lines[0]}, TwoLineGridOptions()));
}

}  // namespace
}  // namespace vpslam
