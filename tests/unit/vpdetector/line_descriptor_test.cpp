#include "vpdetector/line_descriptor.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "tests/unit/vpdetector/vp_scene.h"

namespace vpslam {
namespace {

/// Softened grey noise in blobs of a few pixels: every place looks different.
cv::Mat BlobImage(unsigned seed) {
  cv::Mat small(60, 80, CV_8UC1), image;
  cv::RNG(seed).fill(small, cv::RNG::UNIFORM, 40, 215);
  cv::resize(small, image, cv::Size(640, 480), 0, 0, cv::INTER_CUBIC);
  return image;
}

std::vector<EdgeSegment> RandomSegments(int count, unsigned seed) {
  cv::RNG rng(seed);
  std::vector<EdgeSegment> segments;
  while (static_cast<int>(segments.size()) < count) {
    const Eigen::Vector2d middle(rng.uniform(150., 490.), rng.uniform(150., 330.));
    const double angle = rng.uniform(0., 6.28), length = rng.uniform(50., 150.);
    const Eigen::Vector2d half = 0.5 * length * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    EdgeSegment s;
    s.start_px = middle - half;
    s.end_px = middle + half;
    segments.push_back(s);
  }
  std::sort(segments.begin(), segments.end(),
            [](const EdgeSegment& a, const EdgeSegment& b) { return a.Length() > b.Length(); });
  return segments;
}

/// The same segments seen by a camera that is turned about its axis, shifted, darker and noisy.
struct Moved {
  cv::Mat image;
  std::vector<EdgeSegment> segments;
};
Moved Move(const cv::Mat& image, const std::vector<EdgeSegment>& segments) {
  const cv::Mat warp = cv::getRotationMatrix2D(cv::Point2f(320, 240), 20, 1.1);
  Moved moved;
  cv::warpAffine(image, moved.image, warp, image.size());
  moved.image = 0.7 * moved.image + 20;
  cv::Mat noise(image.size(), CV_8UC1);
  cv::RNG(9).fill(noise, cv::RNG::UNIFORM, 0, 8);
  moved.image += noise;
  const auto apply = [&](const Eigen::Vector2d& p) {
    return Eigen::Vector2d(
        warp.at<double>(0, 0) * p.x() + warp.at<double>(0, 1) * p.y() + warp.at<double>(0, 2),
        warp.at<double>(1, 0) * p.x() + warp.at<double>(1, 1) * p.y() + warp.at<double>(1, 2));
  };
  for (EdgeSegment s : segments) {
    s.start_px = apply(s.start_px);
    s.end_px = apply(s.end_px);
    moved.segments.push_back(s);
  }
  return moved;
}

TEST(LineDescriptorTest, FindsTheSameLinesInATurnedAndDarkerImage) {
  const Camera camera = SceneCamera();
  const cv::Mat image = BlobImage(1);
  const std::vector<EdgeSegment> segments = RandomSegments(60, 2);
  const auto first = DescribeLines(image, camera, segments, LineDescriptorOptions());
  const Moved moved = Move(image, segments);
  const auto second = DescribeLines(moved.image, camera, moved.segments, LineDescriptorOptions());
  ASSERT_EQ(first.size(), segments.size());
  ASSERT_EQ(second.size(), segments.size());
  int right = 0;
  double same = 0, different = 0;
  for (size_t i = 0; i < first.size(); ++i) {
    size_t nearest = 0;
    for (size_t j = 0; j < second.size(); ++j) {
      if (Distance(first[i], second[j]) < Distance(first[i], second[nearest])) nearest = j;
      if (i != j) different += Distance(first[i], second[j]);
    }
    right += nearest == i;
    same += Distance(first[i], second[i]);
  }
  const double n = static_cast<double>(first.size());
  EXPECT_GE(right, 57);  // of 60
  EXPECT_LT(same / n, 30);
  EXPECT_GT(different / (n * (n - 1)), 80);
}

TEST(LineDescriptorTest, OnlyTheLongestGetOne) {
  const Camera camera = SceneCamera();
  const cv::Mat image = BlobImage(1);
  const std::vector<EdgeSegment> segments = RandomSegments(60, 2);
  LineDescriptorOptions options;
  options.max_lines = 10;
  EXPECT_EQ(DescribeLines(image, camera, segments, options).size(), 10u);
  options.max_lines = 1000;
  options.min_length_px = 100;
  const auto described = DescribeLines(image, camera, segments, options);
  ASSERT_LT(described.size(), segments.size());
  EXPECT_GE(segments[described.size() - 1].Length(), 100);
  EXPECT_LT(segments[described.size()].Length(), 100);
}

TEST(LineDescriptorTest, SurvivesLinesOutsideTheImageAndNone) {
  const Camera camera = SceneCamera();
  const cv::Mat image = BlobImage(1);
  EXPECT_TRUE(DescribeLines(image, camera, {}, LineDescriptorOptions()).empty());
  EdgeSegment s;
  s.start_px = {-1000, -1000};
  s.end_px = {2000, 5000};
  EXPECT_EQ(DescribeLines(image, camera, {s}, LineDescriptorOptions()).size(), 1u);
  const cv::Mat tiny(16, 16, CV_8UC1, cv::Scalar(7));
  EXPECT_EQ(DescribeLines(tiny, camera, {s}, LineDescriptorOptions()).size(), 1u);
}

}  // namespace
}  // namespace vpslam
