#include "core/features/corner_accuracy.h"

#include <cmath>
#include <numbers>

#include <Eigen/LU>
#include <gtest/gtest.h>

namespace vpslam {
namespace {

const ScalePyramid kScales(8, 1.2, 0.9);

/// Standard deviation in the direction, in px, where it is an axis of the ellipse.
double Sigma_px(const Keypoint& keypoint, double direction_rad) {
  const Eigen::Vector2d direction(std::cos(direction_rad), std::sin(direction_rad));
  return 1 / direction.dot(CornerSqrtInformation(keypoint, kScales) * direction);
}

TEST(CornerAccuracy, SigmaGrowsWithTheOctaveAndForWeakCorners) {
  for (const double direction_rad : {0.0, 0.7, 2.0}) {
    EXPECT_NEAR(Sigma_px({.octave = 2}, direction_rad), kScales.sigma_px(2), 1e-12)
        << "score unknown";
    EXPECT_NEAR(Sigma_px({.response = 7, .octave = 2}, direction_rad),
                std::sqrt(2) * kScales.sigma_px(2), 1e-12);
    EXPECT_LT(Sigma_px({.response = 100}, direction_rad), 1.01 * kScales.sigma_px(0));
  }
}

TEST(CornerAccuracy, AlongAnEdgeTheNoiseCountsMore) {
  const Keypoint edge{.response = 7, .roundness_per_10000 = 10, .edge_mrad = 500};
  EXPECT_NEAR(Sigma_px(edge, 0.5), std::sqrt(1 + 100) * kScales.sigma_px(0), 1e-3);
  EXPECT_NEAR(Sigma_px(edge, 0.5 + std::numbers::pi / 2), std::sqrt(2) * kScales.sigma_px(0), 1e-6);
  const Keypoint strong{.response = 70, .roundness_per_10000 = 10, .edge_mrad = 500};
  EXPECT_NEAR(Sigma_px(strong, 0.5), std::sqrt(2) * kScales.sigma_px(0), 1e-3);
  const Keypoint straight{.response = 7, .roundness_per_10000 = 0};
  EXPECT_TRUE(CornerSqrtInformation(straight, kScales).allFinite());
  EXPECT_GT(Sigma_px(straight, 0), 25);
}

TEST(CornerAccuracy, IsSymmetricAndPositive) {
  for (int16_t edge_mrad = 0; edge_mrad < 3142; edge_mrad += 100) {
    const Eigen::Matrix2d w = CornerSqrtInformation(
        {.response = 5, .roundness_per_10000 = 100, .edge_mrad = edge_mrad}, kScales);
    EXPECT_DOUBLE_EQ(w(0, 1), w(1, 0));
    EXPECT_GT(w.determinant(), 0);
    EXPECT_GT(w.trace(), 0);
  }
}

}  // namespace
}  // namespace vpslam
