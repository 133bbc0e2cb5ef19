#include "frontend/preview_painter.h"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace vpslam {
namespace {

Camera SomeCamera(int width = 320, int height = 240) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 200;
  camera.cx = width / 2;
  camera.cy = height / 2;
  return camera;
}

/// Horizontal lines, line i at y = 20 + 20 i with the label i, and as many vanishing points.
std::shared_ptr<LineSet> Lines(const std::vector<Eigen::Vector3d>& directions) {
  auto lines = std::make_shared<LineSet>();
  for (size_t i = 0; i < directions.size(); ++i) {
    VanishingPoint vp;
    vp.direction_in_cam = directions[i];
    lines->vanishing_points.push_back(vp);
    LineSegment line;
    line.start_px = {10, 20.f + 20 * i};
    line.end_px = {300, 20.f + 20 * i};
    line.label = static_cast<int>(i);
    lines->lines.push_back(line);
  }
  return lines;
}

/// 0 blue, 1 green, 2 red; -1 where none is clearly the strongest.
int Colour(const cv::Mat& picture, int x, int y) {
  const auto pixel = picture.at<cv::Vec3b>(y, x);
  for (int c = 0; c < 3; ++c) {
    if (pixel[c] > pixel[(c + 1) % 3] + 60 && pixel[c] > pixel[(c + 2) % 3] + 60) return c;
  }
  return -1;
}

TEST(PreviewPainter, DirectionsAreRedGreenAndBlueAndKeepTheirColour) {
  using Eigen::Vector3d;
  PreviewPainter painter(SomeCamera());
  PreviewScene scene;
  scene.image = cv::Mat(240, 320, CV_8UC1, cv::Scalar(80));
  scene.lines = Lines(
      {Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ(), Vector3d(1, 1, 0).normalized()});
  cv::Mat picture = painter.Paint(scene);
  EXPECT_EQ(picture.size(), cv::Size(320, 240));
  EXPECT_EQ(Colour(picture, 150, 20), 2);
  EXPECT_EQ(Colour(picture, 150, 40), 1);
  EXPECT_EQ(Colour(picture, 150, 60), 0);
  EXPECT_EQ(Colour(picture, 150, 80), -1) << "a fourth direction is grey";
  EXPECT_EQ(Colour(picture, 150, 150), -1);
  EXPECT_EQ(picture.at<cv::Vec3b>(150, 150), cv::Vec3b(80, 80, 80));
  // In another order, turned a little, one of them pointing the other way.
  scene.lines = Lines(
      {Vector3d(0.1, 0, 1).normalized(), Vector3d(-1, 0, 0.1).normalized(), Vector3d::UnitY()});
  picture = painter.Paint(scene);
  EXPECT_EQ(Colour(picture, 150, 20), 0);
  EXPECT_EQ(Colour(picture, 150, 40), 2);
  EXPECT_EQ(Colour(picture, 150, 60), 1);
}

TEST(PreviewPainter, TrackedPointsAreSquaresWhereTheLensShowsThem) {
  Camera camera = SomeCamera();
  camera.k1 = -0.3;
  PreviewPainter painter(camera);
  PreviewScene scene;  // without an image, from a log of features
  const Eigen::Vector2f point(280, 120);
  scene.tracked_px = {point, {1e9f, -1e9f}};
  const cv::Mat picture = painter.Paint(scene);
  const Eigen::Vector2d at = camera.Distort(point.cast<double>());
  ASSERT_GT((at - point.cast<double>()).norm(), 5);
  EXPECT_EQ(Colour(picture, cvRound(at.x()) + 2, cvRound(at.y())), 1);
  EXPECT_EQ(Colour(picture, cvRound(at.x()), cvRound(at.y())), -1) << "hollow";
  EXPECT_EQ(Colour(picture, 282, 120), -1);
}

TEST(PreviewPainter, LargeImagesAreShrunk) {
  PreviewPainter painter(SomeCamera(1280, 960));
  PreviewScene scene;
  scene.image = cv::Mat(960, 1280, CV_8UC1, cv::Scalar(80));
  scene.tracked_px = {{800, 400}};
  const cv::Mat picture = painter.Paint(scene);
  EXPECT_EQ(picture.size(), cv::Size(640, 480));
  EXPECT_EQ(Colour(picture, 402, 200), 1);
}

TEST(CompressToFit, KeepsTheLimitWhateverThePicture) {
  cv::Mat noise(480, 640, CV_8UC3);
  cv::randu(noise, 0, 255);
  for (const size_t limit : {60000u, 20000u, 3000u}) {
    const std::vector<uint8_t> jpeg = CompressToFit(noise, limit);
    ASSERT_FALSE(jpeg.empty());
    EXPECT_LE(jpeg.size(), limit);
    EXPECT_FALSE(cv::imdecode(jpeg, cv::IMREAD_COLOR).empty());
  }
  EXPECT_TRUE(CompressToFit(noise, 10).empty());
  const std::vector<uint8_t> plain = CompressToFit(cv::Mat(480, 640, CV_8UC3), 60000);
  EXPECT_EQ(cv::imdecode(plain, cv::IMREAD_COLOR).cols, 640) << "no smaller than need be";
}

}  // namespace
}  // namespace vpslam
