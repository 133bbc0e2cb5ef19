#include "core/features/corner_refinement.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/features/corner_detector.h"
#include "tests/unit/core/features/test_images.h"

namespace vpslam {
namespace {

/// A bright quarter plane whose corner lies at (x, y), as a lens and pixels of finite size show it.
cv::Mat CornerAt(double x, double y) {
  constexpr int kSuper = 8;
  cv::Mat fine(40 * kSuper, 40 * kSuper, CV_8UC1, cv::Scalar(60));
  // Centre of pixel 0 is at 0, its left edge at -0.5.
  fine(cv::Rect(0, 0, static_cast<int>(std::lround((x + 0.5) * kSuper)),
                static_cast<int>(std::lround((y + 0.5) * kSuper)))) = 180;
  cv::GaussianBlur(fine, fine, {}, 0.6 * kSuper);
  cv::Mat image;
  cv::resize(fine, image, {40, 40}, 0, 0, cv::INTER_AREA);
  return image;
}

TEST(SubpixelOffset, FollowsACornerBetweenPixels) {
  CornerDetector detector({.margin_px = 5});
  const auto find = [&](double x, double y) {
    const cv::Mat image = CornerAt(x, y);
    std::vector<Corner> corners;
    detector.Detect(image, &corners);
    EXPECT_EQ(corners.size(), 1u);
    const auto [dx, dy] = SubpixelOffset(image, corners[0].x, corners[0].y);
    EXPECT_LE(std::abs(dx), 0.5f);
    EXPECT_LE(std::abs(dy), 0.5f);
    return cv::Point2d(corners[0].x + dx, corners[0].y + dy);
  };
  // A FAST corner lies somewhat inside of the true one, always at the same place relative to it.
  const cv::Point2d reference = find(20, 20);
  double sum2 = 0;
  int n = 0;
  for (double x = 19; x <= 21; x += 0.125) {
    for (double y = 19; y <= 21; y += 0.125) {
      const cv::Point2d error = find(x, y) - reference - cv::Point2d(x - 20, y - 20);
      sum2 += error.dot(error);
      ++n;
    }
  }
  // Rounding to pixels has sqrt(2 / 12) = 0.41 px about its mean.
  EXPECT_LT(std::sqrt(sum2 / n), 0.25);
}

TEST(SubpixelOffset, SymmetricSpotIsInItsMiddle) {
  cv::Mat image(21, 21, CV_8UC1, cv::Scalar(50));
  image.at<uchar>(10, 10) = 200;
  cv::GaussianBlur(image, image, {}, 0.8);
  const auto [dx, dy] = SubpixelOffset(image, 10, 10);
  EXPECT_EQ(dx, 0.0f);
  EXPECT_EQ(dy, 0.0f);
}

TEST(SegmentScore, IsTheScoreOfFast) {
  const cv::Mat image = TexturedImage(200, 150, 3);
  std::vector<cv::KeyPoint> keypoints;
  cv::FAST(image, keypoints, 10, true);
  ASSERT_GT(keypoints.size(), 50u);
  for (const cv::KeyPoint& k : keypoints) {
    // FAST wants more than the threshold, and returns the largest threshold that passes.
    EXPECT_EQ(SegmentScore(image, static_cast<int>(k.pt.x), static_cast<int>(k.pt.y)) - 1,
              static_cast<int>(k.response));
  }
  EXPECT_LE(SegmentScore(cv::Mat(9, 9, CV_8UC1, cv::Scalar(7)), 4, 4), 0);
}

}  // namespace
}  // namespace vpslam
