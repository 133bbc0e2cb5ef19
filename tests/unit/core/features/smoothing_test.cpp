#include "core/features/smoothing.h"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/unit/core/features/test_images.h"

namespace vpslam {
namespace {

TEST(Smoother, AgreesWithOpenCv) {
  for (const cv::Size size : {cv::Size(4, 4), cv::Size(33, 35), cv::Size(200, 151)}) {
    const cv::Mat image = TexturedImage(size.width, size.height, 1);
    cv::Mat expected, smoothed(size, CV_8UC1);
    cv::GaussianBlur(image, expected, {7, 7}, 2.0);
    Smoother().Smooth(image, &smoothed);
    EXPECT_LE(cv::norm(smoothed, expected, cv::NORM_INF), 2);
    EXPECT_LT(cv::norm(smoothed, expected, cv::NORM_L1) / size.area(), 0.6);
  }
}

TEST(Smoother, KeepsGreyValuesAndBorders) {
  for (const int grey : {0, 1, 127, 255}) {
    const cv::Mat image(20, 30, CV_8UC1, cv::Scalar(grey));
    cv::Mat smoothed(20, 30, CV_8UC1);
    Smoother().Smooth(image, &smoothed);
    EXPECT_EQ(cv::norm(smoothed, image, cv::NORM_INF), 0);
  }
}

TEST(Smoother, DoesNotLookBesideTheImage) {
  cv::Mat buffer(100, 100, CV_8UC1, cv::Scalar(255));
  const cv::Mat image = TexturedImage(50, 40, 2);
  cv::Mat part = buffer(cv::Rect(20, 30, 50, 40));
  image.copyTo(part);
  cv::Mat a(40, 50, CV_8UC1), b(40, 50, CV_8UC1);
  Smoother smoother;
  smoother.Smooth(image, &a);
  smoother.Smooth(part, &b);
  EXPECT_EQ(cv::norm(a, b, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace vpslam
