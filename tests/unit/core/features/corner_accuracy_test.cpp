#include "core/features/corner_accuracy.h"

#include <gtest/gtest.h>

namespace vpslam {
namespace {

TEST(CornerSigma, GrowsWithTheOctaveAndForWeakCorners) {
  const ScalePyramid scales(8, 1.2, 0.9);
  EXPECT_DOUBLE_EQ(CornerSigma_px({.octave = 2}, scales), scales.sigma_px(2)) << "score unknown";
  EXPECT_NEAR(CornerSigma_px({.response = 7, .octave = 2}, scales),
              std::sqrt(2) * scales.sigma_px(2), 1e-12);
  EXPECT_LT(CornerSigma_px({.response = 100}, scales), 1.01 * scales.sigma_px(0));
  EXPECT_GT(CornerSigma_px({.response = 5}, scales), CornerSigma_px({.response = 20}, scales));
}

}  // namespace
}  // namespace vpslam
