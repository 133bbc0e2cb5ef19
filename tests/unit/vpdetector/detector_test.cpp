#include "vpdetector/detector.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/unit/vpdetector/line_images.h"
#include "tests/unit/vpdetector/vp_scene.h"

namespace vpslam {
namespace {

Camera CameraOfSize(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 0.8 * width;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  return camera;
}

/// Four walls' worth of rectangles: windows of a facade seen at an angle.
cv::Mat Facade(const Camera& camera, const Eigen::Quaterniond& cam_from_manhattan) {
  std::vector<Quad> quads;
  const auto window = [&](const Eigen::Vector3d& corner, const Eigen::Vector3d& u,
                          const Eigen::Vector3d& v) {
    Quad quad{{}, 200};
    const Eigen::Vector3d corners[] = {corner, corner + u, corner + u + v, corner + v};
    for (size_t i = 0; i < 4; ++i) {
      const Eigen::Vector3d x = cam_from_manhattan * corners[i];
      if (x.z() < 0.1) return;
      quad.corners[i] = camera.Project(x);
    }
    quads.push_back(quad);
  };
  for (int row = -1; row <= 1; ++row) {
    for (int column = 0; column < 4; ++column) {
      // Two walls of a street, at x = +-2, and its end at z = 9.
      const double y = 1.2 * row - 0.4, z = 3 + 1.4 * column;
      window({2, y, z + 0.8}, {0, 0, -0.8}, {0, 0.7, 0});
      window({-2, y, z}, {0, 0, 0.8}, {0, 0.7, 0});
      if (column % 2 == 0) window({-1.6 + 0.9 * column, y, 9}, {1.3, 0, 0}, {0, 0.7, 0});
    }
  }
  return RenderQuads(camera, quads, 60, 2.0);
}

TEST(DetectorTest, FindsTheRotationOfAStreet) {
  const Camera camera = SceneCamera();
  const Eigen::Quaterniond truth = ExpSo3({0.08, -0.2, 0.05});
  const LineSet set = Detector(camera, DetectorOptions()).Detect(Facade(camera, truth));
  EXPECT_EQ(set.manhattan, ManhattanState::kThree);
  EXPECT_LT(RotationErrorSceneDeg(set.cam_from_manhattan.toRotationMatrix(), truth), 0.3);
  EXPECT_GT(set.lines.size(), 40u);
  int labelled = 0, described = 0;
  for (size_t i = 0; i < set.lines.size(); ++i) {
    labelled += set.lines[i].label >= 0;
    described += set.lines[i].has_descriptor;
    EXPECT_GT(set.lines[i].sigma_px, 0);
    if (i > 0) {
      EXPECT_LE((set.lines[i].end_px - set.lines[i].start_px).norm(),
                (set.lines[i - 1].end_px - set.lines[i - 1].start_px).norm() + 1e-3);
    }
  }
  EXPECT_GT(labelled, 35);
  EXPECT_GT(described, 30);
}

void ExpectSame(const LineSet& a, const LineSet& b) {
  ASSERT_EQ(a.lines.size(), b.lines.size());
  for (size_t i = 0; i < a.lines.size(); ++i) {
    EXPECT_EQ(a.lines[i].start_px, b.lines[i].start_px);
    EXPECT_EQ(a.lines[i].end_px, b.lines[i].end_px);
    EXPECT_EQ(a.lines[i].descriptor, b.lines[i].descriptor);
    EXPECT_EQ(a.lines[i].label, b.lines[i].label);
  }
  EXPECT_EQ(a.cam_from_manhattan.coeffs(), b.cam_from_manhattan.coeffs());
  EXPECT_EQ(a.covariance_rad2, b.covariance_rad2);
  EXPECT_EQ(a.vanishing_points.size(), b.vanishing_points.size());
}

TEST(DetectorTest, TheAnswerDependsOnTheImageAlone) {
  const Camera camera = SceneCamera();
  const cv::Mat one = Facade(camera, ExpSo3({0.08, -0.2, 0.05}));
  const cv::Mat other = Facade(camera, ExpSo3({-0.1, 0.3, 0.0}));
  for (const LineDetectorKind kind :
       {LineDetectorKind::kEdLines, LineDetectorKind::kLsd, LineDetectorKind::kFld}) {
    DetectorOptions options;
    options.lines.detector.kind = kind;
    const Detector detector(camera, options);
    const LineSet first = detector.Detect(one);
    detector.Detect(other);
    ExpectSame(first, detector.Detect(one));
    ExpectSame(first, Detector(camera, options).Detect(one.clone()));
    // Rows need not lie one behind the other in memory.
    cv::Mat wide(one.rows, one.cols + 37, CV_8UC1, cv::Scalar(99));
    one.copyTo(wide(cv::Rect(0, 0, one.cols, one.rows)));
    ExpectSame(first, detector.Detect(wide(cv::Rect(0, 0, one.cols, one.rows))));
  }
}

/// All images that must not be the end of a detector.
std::vector<std::pair<std::string, cv::Mat>> AwkwardImages() {
  std::vector<std::pair<std::string, cv::Mat>> images;
  const auto flat = [&](const std::string& name, int width, int height, int value) {
    images.emplace_back(name, cv::Mat(height, width, CV_8UC1, cv::Scalar(value)));
  };
  flat("black", 640, 480, 0);
  flat("white", 640, 480, 255);
  flat("tiny", 16, 16, 100);
  flat("narrow", 16, 2000, 100);
  flat("huge", 4000, 3000, 100);
  const auto noise = [&](const std::string& name, int width, int height) {
    cv::Mat image(height, width, CV_8UC1);
    cv::RNG(4).fill(image, cv::RNG::UNIFORM, 0, 256);
    images.emplace_back(name, image);
  };
  noise("noise", 640, 480);
  noise("tiny noise", 16, 16);
  noise("portrait noise", 480, 640);
  cv::Mat edges(3000, 4000, CV_8UC1, cv::Scalar(30));
  for (int i = 0; i < 40; ++i) {
    cv::line(edges, {100 * i, 0}, {4000 - 50 * i, 3000}, cv::Scalar(220), 5, cv::LINE_AA);
  }
  images.emplace_back("huge with lines", edges);
  cv::Mat stripes(480, 640, CV_8UC1);
  for (int x = 0; x < 640; ++x) stripes.col(x).setTo(x / 4 % 2 == 0 ? 40 : 200);
  images.emplace_back("stripes", stripes);
  cv::Mat checkers(480, 640, CV_8UC1);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) checkers.at<uchar>(y, x) = (x / 8 + y / 8) % 2 ? 0 : 255;
  }
  images.emplace_back("checkers", checkers);
  cv::Mat dot(480, 640, CV_8UC1, cv::Scalar(0));
  dot.at<uchar>(240, 320) = 255;
  images.emplace_back("dot", dot);
  return images;
}

TEST(DetectorTest, SurvivesAwkwardImages) {
  for (const auto& [name, image] : AwkwardImages()) {
    for (const LineDetectorKind kind :
         {LineDetectorKind::kEdLines, LineDetectorKind::kLsd, LineDetectorKind::kFld}) {
      DetectorOptions options;
      options.lines.detector.kind = kind;
      SCOPED_TRACE(name + ", " + Name(kind));
      const LineSet set = Detector(CameraOfSize(image.cols, image.rows), options).Detect(image);
      EXPECT_LE(set.lines.size(), static_cast<size_t>(options.lines.max_lines));
      for (const LineSegment& line : set.lines) {
        EXPECT_TRUE(line.start_px.allFinite() && line.end_px.allFinite());
        EXPECT_LT(line.label, static_cast<int>(set.vanishing_points.size()));
      }
      EXPECT_TRUE(set.covariance_rad2.allFinite());
      if (name == "black" || name == "white" || name == "noise" || name == "dot") {
        EXPECT_EQ(set.manhattan, ManhattanState::kNone);
      }
    }
  }
}

TEST(DetectorTest, SurvivesAbsurdIntrinsics) {
  const cv::Mat image = Facade(SceneCamera(), ExpSo3({0.08, -0.2, 0.05}));
  std::vector<Camera> cameras(6, SceneCamera());
  cameras[0].fx = cameras[0].fy = 0.001;
  cameras[1].fx = 60000;
  cameras[1].fy = 1;
  cameras[2].k1 = -5;
  cameras[2].k3 = 100;
  cameras[3].k1 = 1e6;
  cameras[4].p1 = cameras[4].p2 = 3;
  cameras[5].cx = -600;
  cameras[5].cy = 900;
  for (const Camera& camera : cameras) {
    ASSERT_FALSE(camera.Validate());
    for (const VpMethod method : {VpMethod::kThreeLine, VpMethod::kTwoLineGrid}) {
      DetectorOptions options;
      options.vps.method = method;
      const LineSet set = Detector(camera, options).Detect(image);
      for (const LineSegment& line : set.lines) {
        EXPECT_TRUE(line.start_px.allFinite() && line.end_px.allFinite());
      }
      EXPECT_TRUE(set.covariance_rad2.allFinite());
      EXPECT_TRUE(set.cam_from_manhattan.coeffs().allFinite());
    }
  }
}

TEST(DetectorTest, RefusesWhatIsNoMatch) {
  Camera camera = SceneCamera();
  const Detector detector(camera, DetectorOptions());
  EXPECT_THROW(detector.Detect(cv::Mat(480, 641, CV_8UC1)), std::invalid_argument);
  EXPECT_THROW(detector.Detect(cv::Mat(480, 640, CV_8UC3)), std::invalid_argument);
  EXPECT_THROW(detector.Detect(cv::Mat()), std::invalid_argument);
  camera.fx = std::nan("");
  EXPECT_THROW(Detector(camera, DetectorOptions()), std::invalid_argument);
  DetectorOptions options;
  options.lines.border_px = -1;
  EXPECT_THROW(Detector(SceneCamera(), options), std::invalid_argument);
}

}  // namespace
}  // namespace vpslam
