#include "vpdetector/image_tool.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "tests/unit/vpdetector/line_images.h"
#include "tests/unit/vpdetector/vp_scene.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

class ImageToolTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              ("image_tool_" +
               std::string(testing::UnitTest::GetInstance()->current_test_info()->name()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    std::ofstream(folder_ / "camera.yaml")
        << "width: 640\nheight: 480\nfx: 520\nfy: 520\ncx: 319.5\ncy: 239.5\n";
    const Quad quad = TurnedRectangle({320, 240}, 300, 200, 0.2, 200);
    cv::imwrite((folder_ / "a.png").string(), RenderQuads(SceneCamera(), {quad}, 60));
    options_.camera_file = (folder_ / "camera.yaml").string();
    options_.images = {(folder_ / "a.png").string()};
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string Message() {
    std::ostringstream out;
    try {
      RunImageTool(options_, out);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  }

  fs::path folder_;
  ImageToolOptions options_;
};

TEST_F(ImageToolTest, WritesTextAndPicture) {
  options_.draw_directory = (folder_ / "new" / "drawn").string();
  std::ostringstream out;
  RunImageTool(options_, out);
  std::istringstream lines(out.str());
  std::string word;
  int segments = 0;
  std::string line;
  std::getline(lines, line);
  EXPECT_NE(line.find("a.png lines"), std::string::npos);
  while (std::getline(lines, line)) segments += line.starts_with("line ");
  EXPECT_GE(segments, 4);
  const cv::Mat picture = cv::imread((folder_ / "new" / "drawn" / "a_lines.png").string());
  EXPECT_EQ(picture.size(), cv::Size(640, 480));
}

TEST_F(ImageToolTest, PaintsAxesRedGreenBlueAndTheRestGrey) {
  LineSet set;
  set.manhattan = ManhattanState::kThree;
  set.vanishing_points.resize(3);
  for (int label = -1; label < 3; ++label) {
    LineSegment line;
    line.start_px = {100, 100.f + 50 * label};
    line.end_px = {300, 100.f + 50 * label};
    line.label = label;
    set.lines.push_back(line);
  }
  const cv::Mat gray(480, 640, CV_8UC1, cv::Scalar(0));
  const cv::Mat picture = DrawLineSet(gray, SceneCamera(), set);
  const auto at = [&](int y) { return picture.at<cv::Vec3b>(y, 200); };  // blue, green, red
  EXPECT_GT(at(100)[2], at(100)[0] + 100);
  EXPECT_GT(at(150)[1], at(150)[2] + 100);
  EXPECT_GT(at(200)[0], at(200)[2] + 100);
  EXPECT_EQ(at(50)[0], at(50)[2]);
}

TEST_F(ImageToolTest, NamesTheFault) {
  options_.images = {(folder_ / "none.png").string()};
  EXPECT_NE(Message().find("none.png"), std::string::npos);
  std::ofstream(folder_ / "text.png") << "no image";
  options_.images = {(folder_ / "text.png").string()};
  EXPECT_NE(Message().find("text.png"), std::string::npos);
  cv::imwrite((folder_ / "small.png").string(), cv::Mat(100, 100, CV_8UC1, cv::Scalar(0)));
  options_.images = {(folder_ / "small.png").string()};
  EXPECT_NE(Message().find("100 x 100"), std::string::npos);
  options_.camera_file = (folder_ / "no.yaml").string();
  EXPECT_NE(Message().find("no.yaml"), std::string::npos);
  options_.camera_file = (folder_ / "camera.yaml").string();
  options_.draw_directory = (folder_ / "camera.yaml" / "x").string();
  EXPECT_NE(Message().find("--draw"), std::string::npos);
  EXPECT_EQ(Message().find('\n'), std::string::npos);
}

}  // namespace
}  // namespace vpslam
