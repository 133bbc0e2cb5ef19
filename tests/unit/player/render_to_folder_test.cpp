#include "player/render_to_folder.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/geometry/se3.h"
#include "player/source_factory.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class RenderedFolder : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() /
              fmt::format("vpslam_render_{}_{}", getpid(),
                          ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path folder_;
};

TEST_F(RenderedFolder, IsReadBackAsItWasSimulated) {
  auto simulator = simulator::Simulator::Create("sim:corridor?frames=3&distortion=1");
  int written = 0;
  RenderToFolder(simulator, folder_, [&](int n) { written = n; });
  EXPECT_EQ(written, 3);

  const auto source = OpenSource(folder_.string(), {});
  const Camera &read = source->camera(), &truth = simulator.camera();
  EXPECT_EQ(read.K(), truth.K());
  EXPECT_EQ(read.k1, truth.k1);
  EXPECT_EQ(read.p2, truth.p2);
  EXPECT_EQ(read.fps, truth.fps);
  int i = 0;
  for (; const auto frame = source->Next(); ++i) {
    EXPECT_EQ(frame->stamp_us, simulator.stamp_us(i));
    const cv::Mat1b image = simulator.Render(i), stored = frame->grey;
    EXPECT_TRUE(std::equal(image.begin(), image.end(), stored.begin(), stored.end()));
    const auto pose = source->WorldFromCam(frame->stamp_us);
    ASSERT_TRUE(pose);
    EXPECT_LT(LocalCoordinates(*pose, simulator.world_from_cam(i)).norm(), 1e-8);
  }
  EXPECT_EQ(i, 3);
}

TEST_F(RenderedFolder, HoldsTheTruthOfLinesAndDirections) {
  auto simulator = simulator::Simulator::Create("sim:corridor?frames=1");
  RenderToFolder(simulator, folder_, [](int) {});
  std::ifstream lines(folder_ / "lines3d.txt");
  std::string header;
  std::getline(lines, header);
  EXPECT_THAT(header, HasSubstr("# ax ay az bx by bz kind axis"));
  size_t n = 0;
  Eigen::Vector3d a, b;
  std::string kind;
  int axis = 0;
  while (lines >> a.x() >> a.y() >> a.z() >> b.x() >> b.y() >> b.z() >> kind >> axis) {
    const simulator::Line3d& line = simulator.lines3d().at(n++);
    EXPECT_LT((a - line.a).norm() + (b - line.b).norm(), 5e-6);
    EXPECT_EQ(kind, line.kind == simulator::LineKind::kEdge ? "edge" : "mark");
    ASSERT_LT(axis, 3);
    if (axis >= 0) {
      EXPECT_NEAR(std::abs(simulator.manhattan().col(axis).dot((b - a).normalized())), 1, 1e-6);
    }
  }
  EXPECT_TRUE(lines.eof());
  EXPECT_EQ(n, simulator.lines3d().size());

  std::ifstream manhattan(folder_ / "manhattan.txt");
  std::getline(manhattan, header);
  std::string frame;
  Eigen::Matrix3d axes;
  manhattan >> frame;
  for (int i = 0; i < 9; ++i) manhattan >> axes(i % 3, i / 3);
  EXPECT_TRUE(manhattan);
  EXPECT_EQ(frame, "world");
  EXPECT_TRUE(axes.isApprox(simulator.manhattan(), 1e-8));
}

TEST_F(RenderedFolder, IsNotWrittenOverAnother) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "precious") << "data";
  auto simulator = simulator::Simulator::Create("sim:corridor?frames=1");
  try {
    RenderToFolder(simulator, folder_, [](int) {});
    FAIL() << "wrote into a folder that is not empty";
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr(folder_.string() + ": exists and is not empty"));
  }
}

}  // namespace
}  // namespace vpslam
