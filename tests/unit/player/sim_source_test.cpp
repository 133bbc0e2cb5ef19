#include "player/sim_source.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "player/source_factory.h"

namespace vpslam {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string ErrorOf(const std::string& name, const SourceOptions& options) {
  try {
    OpenSource(name, options);
  } catch (const std::runtime_error& e) {
    return e.what();
  }
  return "no error";
}

TEST(SimSource, DeliversTheAskedForFramesWithTruth) {
  SourceOptions options;
  options.start = 2;
  options.max_frames = 3;
  const auto source = OpenSource("sim:corridor?frames=10", options);
  EXPECT_EQ(source->camera().width, 640);
  EXPECT_FALSE(source->camera().HasDistortion());
  std::vector<int64_t> stamps;
  std::optional<SE3> before;
  while (const auto frame = source->Next()) {
    stamps.push_back(frame->stamp_us);
    EXPECT_EQ(frame->grey.type(), CV_8UC1);
    EXPECT_EQ(frame->grey.size(), cv::Size(640, 480));
    EXPECT_GT(frame->decode_ms, 0);
    const std::optional<SE3> pose = source->WorldFromCam(frame->stamp_us);
    ASSERT_TRUE(pose);
    if (before) {
      EXPECT_GT((pose->translation - before->translation).norm(), 1e-3);
    }
    before = pose;
  }
  EXPECT_THAT(stamps, ElementsAre(1'066'666, 1'100'000, 1'133'333));
  EXPECT_FALSE(source->WorldFromCam(5'000'000));
}

TEST(SimSource, NamesWhatIsWrong) {
  EXPECT_THAT(ErrorOf("sim:kitchen", {}), HasSubstr("no scene 'kitchen'"));
  SourceOptions late;
  late.start = 5;
  EXPECT_THAT(ErrorOf("sim:corridor?frames=5", late),
              HasSubstr("has 5 frames, and --start 5 leaves none"));

  SourceOptions other_camera;
  other_camera.camera_file =
      (std::filesystem::temp_directory_path() / fmt::format("vpslam_sim_{}.yaml", getpid()))
          .string();
  std::ofstream(other_camera.camera_file)
      << "width: 320\nheight: 240\nfx: 260\nfy: 260\ncx: 160\ncy: 120\n";
  EXPECT_THAT(ErrorOf("sim:corridor", other_camera), HasSubstr("leave out --camera"));
  std::filesystem::remove(other_camera.camera_file);
}

}  // namespace
}  // namespace vpslam
