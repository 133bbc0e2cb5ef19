#include "core/features/orb_extractor.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <gtest/gtest.h>

#include "tests/unit/core/features/test_images.h"

namespace vpslam {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

int MedianOf(std::vector<int> v) {
  std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
  return v[v.size() / 2];
}

bool Same(const Features& a, const Features& b) {
  if (a.descriptors != b.descriptors || a.size() != b.size()) return false;
  for (int i = 0; i < a.size(); ++i) {
    const Keypoint &p = a.keypoints[i], &q = b.keypoints[i];
    if (p.x_px != q.x_px || p.y_px != q.y_px || p.angle_rad != q.angle_rad ||
        p.response != q.response || p.octave != q.octave) {
      return false;
    }
  }
  return true;
}

void ExpectSane(const Features& features, const Camera& camera, const OrbOptions& options) {
  ASSERT_EQ(features.keypoints.size(), features.descriptors.size());
  EXPECT_LE(features.size(), options.num_features);
  const Camera::Bounds bounds = camera.UndistortedBounds();
  for (const Keypoint& k : features.keypoints) {
    EXPECT_TRUE(bounds.Contains(k.Position()));
    EXPECT_GE(k.angle_rad, 0.0f);
    EXPECT_LT(k.angle_rad, static_cast<float>(kTwoPi));
    EXPECT_GE(k.octave, 0);
    EXPECT_LT(k.octave, options.num_levels);
    EXPECT_GT(k.response, 0.0f);
  }
}

/// What the features of `a` find in `b`, where x_b = transform x_a: the distance of descriptors to
/// the key point nearest to the true place, of about the octave expected, and to a random one.
struct Comparison {
  std::vector<int> true_distances, random_distances;
  std::vector<double> angle_errors_rad;
  double repeated = 0;  ///< share of features with a key point near the true place
};

Comparison Compare(const Features& a, const Features& b, const cv::Matx23d& transform,
                   double octave_shift, double turn_rad, const Camera& camera) {
  Comparison c;
  int inside = 0;
  for (int i = 0; i < a.size(); ++i) {
    const Keypoint& k = a.keypoints[i];
    const cv::Vec2d x = transform * cv::Vec3d(k.x_px, k.y_px, 1);
    const double expected_octave = k.octave + octave_shift;
    if (x[0] < 80 || x[1] < 80 || x[0] > camera.width - 80 || x[1] > camera.height - 80) continue;
    if (expected_octave < -0.5 || expected_octave > 7.5) continue;
    ++inside;
    int best = -1;
    double best_px = 1.5 * std::pow(1.2, expected_octave);
    for (int j = 0; j < b.size(); ++j) {
      const double px = std::hypot(b.keypoints[j].x_px - x[0], b.keypoints[j].y_px - x[1]);
      if (px < best_px && std::abs(b.keypoints[j].octave - expected_octave) < 0.75) {
        best = j;
        best_px = px;
      }
    }
    c.random_distances.push_back(Distance(a.descriptors[i], b.descriptors[(i * 37) % b.size()]));
    if (best < 0) continue;
    c.true_distances.push_back(Distance(a.descriptors[i], b.descriptors[best]));
    c.angle_errors_rad.push_back(
        std::abs(std::remainder(b.keypoints[best].angle_rad - k.angle_rad - turn_rad, kTwoPi)));
  }
  c.repeated = static_cast<double>(c.true_distances.size()) / inside;
  return c;
}

cv::Matx23d RotationAboutCentre(const Camera& camera, double degrees, double scale) {
  const double s = std::sin(degrees * std::numbers::pi / 180) * scale;
  const double c = std::cos(degrees * std::numbers::pi / 180) * scale;
  return {c, -s, camera.cx - c * camera.cx + s * camera.cy,
          s, c,  camera.cy - s * camera.cx - c * camera.cy};
}

TEST(OrbExtractor, DescriptorsAreInvariantToRotation) {
  const Camera camera = PinholeCamera();
  OrbExtractor extractor(camera, {});
  const cv::Mat image = TexturedImage(640, 480, 1);
  const Features original = extractor.Extract(image);
  for (int degrees = 15; degrees < 360; degrees += 30) {
    const cv::Matx23d transform = RotationAboutCentre(camera, degrees, 1.0);
    cv::Mat rotated;
    cv::warpAffine(image, rotated, transform, image.size(), cv::INTER_CUBIC);
    const Comparison c = Compare(original, extractor.Extract(rotated), transform, 0,
                                 degrees * std::numbers::pi / 180, camera);
    ASSERT_GT(c.true_distances.size(), 100u);
    EXPECT_GT(c.repeated, 0.4) << degrees;
    EXPECT_LT(MedianOf(c.true_distances), 35) << degrees;
    EXPECT_GT(MedianOf(c.random_distances), 90) << degrees;
    EXPECT_GT(std::count_if(c.angle_errors_rad.begin(), c.angle_errors_rad.end(),
                            [](double e) { return e < 0.2; }),
              static_cast<std::ptrdiff_t>(0.8 * static_cast<double>(c.angle_errors_rad.size())))
        << degrees;
  }
}

TEST(OrbExtractor, ScaleShowsInTheOctave) {
  const Camera camera = PinholeCamera();
  OrbExtractor extractor(camera, {});
  const cv::Mat image = TexturedImage(640, 480, 2);
  const Features original = extractor.Extract(image);
  for (const int shift : {1, 2, 3}) {
    const cv::Matx23d transform = RotationAboutCentre(camera, 0, std::pow(1.2, shift));
    cv::Mat scaled;
    cv::warpAffine(image, scaled, transform, image.size(), cv::INTER_CUBIC);
    const Comparison c = Compare(original, extractor.Extract(scaled), transform, shift, 0, camera);
    ASSERT_GT(c.true_distances.size(), 50u);
    EXPECT_GT(c.repeated, 0.4) << shift;
    EXPECT_LT(MedianOf(c.true_distances), 35) << shift;
    EXPECT_GT(MedianOf(c.random_distances), 90) << shift;
  }
}

TEST(OrbExtractor, AllOctavesShowTheSamePlace) {
  // A square whose corners are seen at all scales, at places that cannot be told apart by level.
  const Camera camera = PinholeCamera();
  cv::Mat image(480, 640, CV_8UC1, cv::Scalar(40));
  const cv::Rect square(250, 170, 140, 140);
  image(square) = 200;
  const Features features = OrbExtractor(camera, {}).Extract(image);
  const ScalePyramid scales(8, 1.2);
  std::set<int> octaves;
  for (const Keypoint& k : features.keypoints) {
    // Corners of the square between pixels: (249.5, 169.5), ...
    const double dx = std::min(std::abs(k.x_px - 249.5), std::abs(k.x_px - 389.5));
    const double dy = std::min(std::abs(k.y_px - 169.5), std::abs(k.y_px - 309.5));
    EXPECT_LT(std::max(dx, dy), 2.0 * scales.scale(k.octave));
    octaves.insert(k.octave);
  }
  EXPECT_GE(octaves.size(), 7u);  // resampling may hide a corner
  // The mean over the four corners has no bias towards one side, on any level.
  for (const int octave : octaves) {
    double x = 0, y = 0;
    int n = 0;
    for (const Keypoint& k : features.keypoints) {
      if (k.octave != octave) continue;
      x += k.x_px;
      y += k.y_px;
      ++n;
    }
    EXPECT_NEAR(x / n, 319.5, 0.55 * scales.scale(octave)) << octave << " " << n;
    EXPECT_NEAR(y / n, 239.5, 0.55 * scales.scale(octave)) << octave << " " << n;
  }
}

TEST(OrbExtractor, WeakTextureIsCoveredToo) {
  const Camera camera = PinholeCamera();
  // Left half strong, right half of a twelfth of the contrast: too weak for the first threshold.
  cv::Mat image = TexturedImage(640, 480, 3);
  cv::Mat right = image.colRange(320, 640);
  right.convertTo(right, -1, 1.0 / 12, 110);
  const Features features = OrbExtractor(camera, {}).Extract(image);
  EXPECT_EQ(features.size(), 1000);
  std::set<std::pair<int, int>> left_cells, right_cells;
  for (const Keypoint& k : features.keypoints) {
    const std::pair<int, int> cell(static_cast<int>(k.x_px) / 40, static_cast<int>(k.y_px) / 40);
    (cell.first < 8 ? left_cells : right_cells).insert(cell);
  }
  EXPECT_GE(left_cells.size(), 85u);  // of 96
  EXPECT_GE(right_cells.size(), 65u);
}

TEST(OrbExtractor, IsDeterministic) {
  const Camera camera = PinholeCamera();
  const cv::Mat image = TexturedImage(640, 480, 4), other = TexturedImage(640, 480, 5);
  OrbExtractor extractor(camera, {});
  const Features features = extractor.Extract(image);
  EXPECT_TRUE(Same(features, extractor.Extract(image)));
  EXPECT_FALSE(Same(features, extractor.Extract(other)));  // and nothing is left of it:
  EXPECT_TRUE(Same(features, extractor.Extract(image)));
  EXPECT_TRUE(Same(features, OrbExtractor(camera, {}).Extract(image)));
  // The row step of the image does not matter, nor what lies beside it.
  cv::Mat wide(500, 700, CV_8UC1, cv::Scalar(255));
  image.copyTo(wide(cv::Rect(13, 7, 640, 480)));
  EXPECT_TRUE(Same(features, extractor.Extract(wide(cv::Rect(13, 7, 640, 480)))));
}

TEST(OrbExtractor, PlainImagesHaveNoFeatures) {
  const Camera camera = PinholeCamera();
  OrbExtractor extractor(camera, {});
  for (const int grey : {0, 128, 255}) {
    EXPECT_EQ(extractor.Extract(cv::Mat(480, 640, CV_8UC1, cv::Scalar(grey))).size(), 0);
  }
}

TEST(OrbExtractor, NoiseAndTwoValuedImages) {
  const Camera camera = PinholeCamera();
  OrbExtractor extractor(camera, {});
  cv::Mat noise(480, 640, CV_8UC1);
  cv::RNG rng(6);
  rng.fill(noise, cv::RNG::UNIFORM, 0, 256);
  Features features = extractor.Extract(noise);
  EXPECT_EQ(features.size(), 1000);
  ExpectSane(features, camera, {});
  cv::threshold(noise, noise, 127, 255, cv::THRESH_BINARY);
  features = extractor.Extract(noise);
  EXPECT_EQ(features.size(), 1000);
  ExpectSane(features, camera, {});
}

TEST(OrbExtractor, AllSizesFromTinyToPortrait) {
  for (const cv::Size size :
       {cv::Size(16, 16), cv::Size(32, 32), cv::Size(33, 33), cv::Size(41, 300), cv::Size(97, 53),
        cv::Size(480, 640), cv::Size(1241, 376), cv::Size(2000, 60)}) {
    const Camera camera = PinholeCamera(size.width, size.height);
    const Features features =
        OrbExtractor(camera, {}).Extract(TexturedImage(size.width, size.height, 7));
    ExpectSane(features, camera, {});
    if (size.area() < 33 * 33) {
      EXPECT_EQ(features.size(), 0);
    }
    if (size.area() > 100000) {
      EXPECT_GT(features.size(), 500);
    }
  }
}

TEST(OrbExtractor, KeypointsAreUndistorted) {
  Camera camera = PinholeCamera();
  const cv::Mat image = TexturedImage(640, 480, 8);
  const Features distorted = OrbExtractor(camera, {}).Extract(image);
  camera.k1 = -0.28;
  camera.k2 = 0.07;
  camera.p1 = 0.0002;
  const Features undistorted = OrbExtractor(camera, {}).Extract(image);
  // The image is the same, so the features are, except for their coordinates.
  ASSERT_EQ(undistorted.size(), distorted.size());
  EXPECT_EQ(undistorted.descriptors, distorted.descriptors);
  double largest_px = 0;
  for (int i = 0; i < distorted.size(); ++i) {
    const Eigen::Vector2d back = camera.Distort(undistorted.keypoints[i].Position());
    EXPECT_LT((back - distorted.keypoints[i].Position()).norm(), 1e-3);
    const Keypoint& k = undistorted.keypoints[i];
    const Eigen::Vector2d edge(std::cos(1e-3 * k.edge_mrad), std::sin(1e-3 * k.edge_mrad));
    const Eigen::Vector2d as_seen =
        camera.Distort(k.Position() + edge) - camera.Distort(k.Position() - edge);
    EXPECT_NEAR(std::remainder(
                    std::atan2(as_seen.y(), as_seen.x()) - 1e-3 * distorted.keypoints[i].edge_mrad,
                    std::numbers::pi),
                0, 0.01);
    largest_px =
        std::max(largest_px,
                 (undistorted.keypoints[i].Position() - distorted.keypoints[i].Position()).norm());
  }
  EXPECT_GT(largest_px, 20);
}

TEST(OrbExtractor, WhereTheLensModelFoldsOverNothingIsFound) {
  Camera camera = PinholeCamera();
  camera.k1 = -1.0;  // r (1 - r^2) has its maximum at r = 0.577, where it is 0.385 = 197 px
  const Features features = OrbExtractor(camera, {}).Extract(TexturedImage(640, 480, 9));
  EXPECT_GT(features.size(), 50);
  for (const Keypoint& k : features.keypoints) {
    const Eigen::Vector2d distorted = camera.Distort(k.Position());
    EXPECT_LT((distorted - Eigen::Vector2d(camera.cx, camera.cy)).norm(), 198);
  }
}

TEST(OrbExtractor, NumberOfFeaturesIsALimitThatIsReached) {
  const Camera camera = PinholeCamera();
  const cv::Mat image = TexturedImage(640, 480, 10);
  for (const int n : {1, 10, 500, 2000}) {
    const OrbOptions options{.num_features = n};
    const Features features = OrbExtractor(camera, options).Extract(image);
    EXPECT_EQ(features.size(), n);
    ExpectSane(features, camera, options);
  }
}

TEST(OrbExtractor, WrongImagesAndOptionsAreRefused) {
  const Camera camera = PinholeCamera();
  OrbExtractor extractor(camera, {});
  EXPECT_THROW(extractor.Extract(cv::Mat()), std::invalid_argument);
  EXPECT_THROW(extractor.Extract(cv::Mat(480, 640, CV_8UC3)), std::invalid_argument);
  EXPECT_THROW(extractor.Extract(cv::Mat(480, 641, CV_8UC1)), std::invalid_argument);
  EXPECT_THROW(OrbExtractor(Camera(), {}), std::invalid_argument);
  for (const OrbOptions& options :
       {OrbOptions{.num_features = 0}, OrbOptions{.num_levels = 0}, OrbOptions{.scale_factor = 1.0},
        OrbOptions{.fast_threshold = 0}, OrbOptions{.fast_threshold = 4},
        OrbOptions{.fast_threshold_low = 0}, OrbOptions{.cell_px = 1}}) {
    EXPECT_TRUE(options.Validate());
    EXPECT_THROW(OrbExtractor(camera, options), std::invalid_argument);
  }
}

TEST(OrbExtractor, FindsNothingWhereTheMaskHidesTheImage) {
  Camera camera = PinholeCamera();
  camera.k1 = -0.2;  // the mask is of the image as the lens sees it
  const cv::Mat image = TexturedImage(camera.width, camera.height, 7);
  const OrbOptions options;
  const int all = OrbExtractor(camera, options).Extract(image).size();
  const int hidden = camera.width * camera.height / 3;  // the lowest third
  camera.mask_runs = {camera.width * camera.height - hidden, hidden};
  const Features features = OrbExtractor(camera, options).Extract(image);
  for (const Keypoint& k : features.keypoints) {
    EXPECT_LT(camera.Distort(k.Position().cast<double>()).y(),
              camera.height * 2 / 3 + 1.5 * std::pow(options.scale_factor, k.octave));
  }
  EXPECT_GT(features.size(), 0.95 * all) << "others come in their place";
}

}  // namespace
}  // namespace vpslam
