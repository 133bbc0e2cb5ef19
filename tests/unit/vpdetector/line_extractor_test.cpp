#include "vpdetector/line_extractor.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/vpdetector/line_images.h"
#include "tests/unit/vpdetector/vp_scene.h"

namespace vpslam {
namespace {

/// Largest distance of the segment's ends from the line through a and b.
double Distance(const EdgeSegment& s, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d d = (b - a).normalized(), n(-d.y(), d.x());
  return std::max(std::abs(n.dot(s.start_px - a)), std::abs(n.dot(s.end_px - a)));
}

/// Best match of a true edge: the longest segment within 1 px.
const EdgeSegment* Find(const std::vector<EdgeSegment>& segments, const Eigen::Vector2d& a,
                        const Eigen::Vector2d& b) {
  for (const EdgeSegment& s : segments) {  // longest first
    if (Distance(s, a, b) < 1.0) return &s;
  }
  return nullptr;
}

class LineExtractorTest : public testing::TestWithParam<LineDetectorKind> {
 protected:
  LineExtractorOptions Options() const {
    LineExtractorOptions options;
    options.detector.kind = GetParam();
    return options;
  }
};

TEST_P(LineExtractorTest, FindsEdgesToATenthOfAPixel) {
  const Camera camera = SceneCamera();
  double square = 0;
  int count = 0;
  for (int trial = 0; trial < 6; ++trial) {
    const Quad quad = TurnedRectangle({320.3, 240.6}, 300, 220, 0.1 + 0.5 * trial, 200);
    const auto segments = ExtractLines(RenderQuads(camera, {quad}, 60, 3.0), camera, Options());
    for (size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d a = quad.corners[i], b = quad.corners[(i + 1) % 4];
      const EdgeSegment* s = Find(segments, a, b);
      ASSERT_TRUE(s) << "trial " << trial << " edge " << i;
      EXPECT_GT(s->Length(), 0.85 * (b - a).norm());
      EXPECT_LT(s->Length(), 1.05 * (b - a).norm());
      square += std::pow(Distance(*s, a, b), 2);
      ++count;
      // The brighter side, inside the quad, is on the right: the normal (-dy, dx) points there.
      const Eigen::Vector2d d = s->Direction();
      const Eigen::Vector2d to_middle = Eigen::Vector2d(320.3, 240.6) - s->start_px;
      EXPECT_GT(-d.y() * to_middle.x() + d.x() * to_middle.y(), 0);
    }
  }
  EXPECT_LT(std::sqrt(square / count), 0.1);
}

TEST_P(LineExtractorTest, FindsNothingWhereTheMaskHidesTheImage) {
  Camera camera = SceneCamera();
  const Quad quad = TurnedRectangle({320.3, 240.6}, 300, 220, 0.1, 200);
  const cv::Mat image = RenderQuads(camera, {quad}, 60, 3.0);
  const auto lowest = [](const std::vector<EdgeSegment>& segments) {
    double y = 0;
    for (const EdgeSegment& s : segments) y = std::max({y, s.start_px.y(), s.end_px.y()});
    return y;
  };
  const auto all = ExtractLines(image, camera, Options());
  EXPECT_GT(lowest(all), 300);
  const int seen = 260 * camera.width;  // rows 0 to 259
  camera.mask_runs = {seen, camera.width * camera.height - seen};
  const auto segments = ExtractLines(image, camera, Options());
  EXPECT_LT(lowest(segments), 261);
  // The upper edge is whole, those at the sides are cut off.
  EXPECT_GE(segments.size(), 3u);
  EXPECT_NEAR(segments[0].Length(), all[0].Length(), 3);
}

TEST_P(LineExtractorTest, StraightensWhatTheLensBends) {
  Camera camera = SceneCamera();
  camera.k1 = -0.28;
  camera.k2 = 0.07;
  const Quad quad = TurnedRectangle({330, 235}, 560, 400, 0.03, 200);
  const cv::Mat image = RenderQuads(camera, {quad}, 60, 2.0);
  const auto segments = ExtractLines(image, camera, Options());
  for (size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = quad.corners[i], b = quad.corners[(i + 1) % 4];
    // As one segment, or as fragments that all lie on the true edge.
    double covered = 0;
    for (const EdgeSegment& s : segments) {
      if (Distance(s, a, b) > 3.0) continue;
      EXPECT_LT(Distance(s, a, b), 0.5) << "edge " << i;
      covered += s.Length();
    }
    EXPECT_GT(covered, 0.8 * (b - a).norm()) << "edge " << i;
  }
}

TEST_P(LineExtractorTest, SigmaIsOfTheSizeOfTheError) {
  const Camera camera = SceneCamera();
  double normalised = 0;
  int count = 0;
  for (int trial = 0; trial < 8; ++trial) {
    const Quad quad = TurnedRectangle({318.7, 241.2}, 320, 240, 0.15 + 0.3 * trial, 120);
    LineExtractorOptions options = Options();
    options.fit.min_sigma_px = 0.01;
    const auto segments = ExtractLines(
        RenderQuads(camera, {quad}, 80, 4.0, static_cast<unsigned>(trial)), camera, options);
    for (size_t i = 0; i < 4; ++i) {
      const Eigen::Vector2d a = quad.corners[i], b = quad.corners[(i + 1) % 4];
      const EdgeSegment* s = Find(segments, a, b);
      if (!s) continue;
      const Eigen::Vector2d d = (b - a).normalized(), n(-d.y(), d.x());
      normalised += std::pow(n.dot(s->start_px - a) / s->sigma_px, 2);
      normalised += std::pow(n.dot(s->end_px - a) / s->sigma_px, 2);
      count += 2;
    }
  }
  ASSERT_GT(count, 50);
  EXPECT_GT(normalised / count, 0.1);
  EXPECT_LT(normalised / count, 4.0);
}

TEST_P(LineExtractorTest, NoLinesOfTheFrameOfTheImage) {
  // A black frame of two pixels, as cameras and rectified images have it.
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(0));
  image(cv::Rect(2, 2, 636, 476)).setTo(180);
  EXPECT_TRUE(ExtractLines(image, SceneCamera(), Options()).empty());
}

INSTANTIATE_TEST_SUITE_P(AllDetectors, LineExtractorTest,
                         testing::Values(LineDetectorKind::kLsd, LineDetectorKind::kEdLines,
                                         LineDetectorKind::kFld),
                         [](const auto& instance) { return Name(instance.param); });

EdgeSegment StraightSegment(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  EdgeSegment s;
  s.start_px = a;
  s.end_px = b;
  for (int i = 0; i <= 20; ++i) s.moments.Add(a + (b - a) * i / 20.0, 1);
  return s;
}

TEST(MergeSegmentsTest, MergesCollinearNeighboursOnly) {
  const EdgeFitOptions options;
  const auto merged = [&](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return MergeSegments({StraightSegment({0, 0}, {100, 0}), StraightSegment(a, b)}, options);
  };
  const auto one = merged({105, 0.3}, {160, 0.2});
  ASSERT_EQ(one.size(), 1u);
  EXPECT_NEAR(one[0].Length(), 160, 0.1);
  EXPECT_EQ(merged({180, 0}, {260, 0}).size(), 2u);   // a gap of 80 px
  EXPECT_EQ(merged({105, 4}, {160, 4}).size(), 2u);   // beside
  EXPECT_EQ(merged({160, 0}, {105, 0}).size(), 2u);   // the other polarity
  EXPECT_EQ(merged({105, 0}, {150, 20}).size(), 2u);  // at an angle
  EXPECT_TRUE(MergeSegments({}, options).empty());
}

TEST(LineExtractorOptionsTest, RefusesNonsense) {
  EXPECT_FALSE(LineExtractorOptions().Validate());
  LineExtractorOptions options;
  options.detector.lsd_scale = 0;
  EXPECT_TRUE(options.Validate());
  options = LineExtractorOptions();
  options.fit.min_points = 1;
  EXPECT_TRUE(options.Validate());
  EXPECT_FALSE(LineDetectorKindFromName("hough"));
  EXPECT_EQ(LineDetectorKindFromName("fld"), LineDetectorKind::kFld);
}

}  // namespace
}  // namespace vpslam
