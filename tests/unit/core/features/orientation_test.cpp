#include "core/features/orientation.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace vpslam {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

double AngleDifference(double a, double b) { return std::abs(std::remainder(a - b, kTwoPi)); }

/// Grey values that rise towards `direction_rad`.
cv::Mat Ramp(double direction_rad) {
  cv::Mat image(41, 41, CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const double along = (x - 20) * std::cos(direction_rad) + (y - 20) * std::sin(direction_rad);
      image.at<uchar>(y, x) = cv::saturate_cast<uchar>(128 + 4 * along);
    }
  }
  return image;
}

TEST(Orientation, FollowsTheBrightSide) {
  for (int degrees = 0; degrees < 360; degrees += 5) {
    const double direction_rad = degrees * std::numbers::pi / 180;
    const float angle_rad = Orientation_rad(Ramp(direction_rad), 20, 20);
    EXPECT_GE(angle_rad, 0.0f);
    EXPECT_LT(angle_rad, static_cast<float>(kTwoPi));
    EXPECT_LT(AngleDifference(angle_rad, direction_rad), 0.01) << degrees;
  }
}

TEST(Orientation, AgreesWithTheMomentsOfTheDisc) {
  cv::Mat image(64, 64, CV_8UC1);
  cv::RNG rng(5);
  rng.fill(image, cv::RNG::UNIFORM, 0, 256);
  for (int y = 15; y < 49; y += 3) {
    for (int x = 15; x < 49; x += 3) {
      double m_x = 0, m_y = 0;
      for (int dy = -15; dy <= 15; ++dy) {
        for (int dx = -15; dx <= 15; ++dx) {
          if (dx * dx + dy * dy > 15.5 * 15.5) continue;
          m_x += dx * image.at<uchar>(y + dy, x + dx);
          m_y += dy * image.at<uchar>(y + dy, x + dx);
        }
      }
      EXPECT_LT(AngleDifference(Orientation_rad(image, x, y), std::atan2(m_y, m_x)), 1e-5);
    }
  }
}

TEST(Orientation, UniformPatchHasAngleZero) {
  const cv::Mat image(31, 31, CV_8UC1, cv::Scalar(77));
  EXPECT_EQ(Orientation_rad(image, 15, 15), 0.0f);
}

}  // namespace
}  // namespace vpslam
