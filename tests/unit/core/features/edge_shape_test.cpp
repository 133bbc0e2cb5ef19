#include "core/features/edge_shape.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

namespace vpslam {
namespace {

constexpr double kPi = std::numbers::pi;

/// Bright on one side of an edge through the middle, as a lens shows it.
cv::Mat EdgeAt(double edge_rad) {
  cv::Mat image(41, 41, CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double across = (y - 20) * std::cos(edge_rad) - (x - 20) * std::sin(edge_rad);
      image.at<uchar>(y, x) = cv::saturate_cast<uchar>(120 + 60 * std::tanh(across / 2));
    }
  }
  return image;
}

TEST(EdgeShape, ASingleEdgeHasNoRoundnessAndItsDirection) {
  for (int degrees = 0; degrees < 180; degrees += 5) {
    const double edge_rad = degrees * kPi / 180;
    const EdgeShape shape = EdgeShapeAt(EdgeAt(edge_rad), 20, 20);
    EXPECT_LT(shape.roundness, 0.002f) << degrees;
    EXPECT_GE(shape.edge_rad, 0.0f);
    EXPECT_LT(shape.edge_rad, static_cast<float>(kPi));
    EXPECT_NEAR(std::remainder(shape.edge_rad - edge_rad, kPi), 0, 0.02) << degrees;
  }
}

TEST(EdgeShape, ARightAngleIsRound) {
  cv::Mat image(41, 41, CV_8UC1, cv::Scalar(60));
  image(cv::Rect(0, 0, 21, 21)) = 180;
  cv::GaussianBlur(image, image, {}, 0.7);
  EXPECT_GT(EdgeShapeAt(image, 20, 20).roundness, 0.5f);
}

TEST(EdgeShape, NoGradientTellsNothing) {
  const cv::Mat image(41, 41, CV_8UC1, cv::Scalar(99));
  EXPECT_EQ(EdgeShapeAt(image, 20, 20).roundness, 1.0f);
}

TEST(EdgeShape, NoiseLeavesItInItsRange) {
  cv::Mat image(64, 64, CV_8UC1);
  cv::RNG rng(3);
  rng.fill(image, cv::RNG::UNIFORM, 0, 256);
  for (int y = 4; y < 60; ++y) {
    for (int x = 4; x < 60; ++x) {
      const EdgeShape shape = EdgeShapeAt(image, x, y);
      EXPECT_GE(shape.roundness, 0.0f);
      EXPECT_LE(shape.roundness, 1.0f);
    }
  }
}

}  // namespace
}  // namespace vpslam
