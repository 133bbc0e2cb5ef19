#include "bench/york_folder.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <gtest/gtest.h>

#include "bench/vp_metrics.h"
#include "core/base/decode_image.h"
#include "vpdetector/line_extractor.h"
#include "vpdetector/vp_estimator.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

class YorkFolderTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) / "york_folder_test";
    fs::remove_all(folder_);
    fs::create_directories(folder_ / "images");
    Write("camera.yaml", "width: 640\nheight: 480\nfx: 500\nfy: 500\ncx: 320\ncy: 240\n");
    Write("images/A.jpg", "not read here");
    Write("manhattan.txt", "# name, directions\nA 2 0 0 0 1 0 0 0 1\n");
    Write("lines.txt", "A 1 2 3 4 2\n");
  }
  void TearDown() override { fs::remove_all(folder_); }
  void Write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
  }
  std::string Fault() {
    try {
      ReadYorkFolder(folder_.string());
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return "";
  }
  fs::path folder_;
};

TEST_F(YorkFolderTest, ReadsTruthAndSegments) {
  const YorkFolder york = ReadYorkFolder(folder_.string());
  ASSERT_EQ(york.images.size(), 1u);
  EXPECT_EQ(york.images[0].truth, Eigen::Matrix3d::Identity());  // normalised
  ASSERT_EQ(york.images[0].segments.size(), 1u);
  EXPECT_EQ(york.images[0].segments[0].axis, 2);
  EXPECT_EQ(york.images[0].segments[0].end_px, Eigen::Vector2d(3, 4));
}

TEST_F(YorkFolderTest, SegmentsMayBeMissing) {
  fs::remove(folder_ / "lines.txt");
  EXPECT_FALSE(ReadYorkFolder(folder_.string()).has_segments);
}

TEST_F(YorkFolderTest, NamesTheFault) {
  Write("lines.txt", "A 1 2 3 4 7\n");
  EXPECT_NE(Fault().find("lines.txt:1"), std::string::npos);
  Write("manhattan.txt", "# x\nA 1 0 0 0 1\n");
  EXPECT_NE(Fault().find("manhattan.txt:2"), std::string::npos);
  Write("manhattan.txt", "B 1 0 0 0 1 0 0 0 1\n");
  EXPECT_NE(Fault().find("B.jpg"), std::string::npos);
  Write("manhattan.txt", "");
  EXPECT_NE(Fault().find("names no image"), std::string::npos);
  fs::remove(folder_ / "manhattan.txt");
  EXPECT_NE(Fault().find("--data"), std::string::npos);
}

/// The defaults keep what was measured on York Urban.
TEST(YorkUrbanTest, DefaultMethodKeepsItsAccuracy) {
  const char* shared = std::getenv("VPSLAM_SHARED_DATA");
  const fs::path folder =
      (shared ? fs::path(shared) : fs::path(VPSLAM_SOURCE_DIR) / "../shared/data") /
      "york_urban_train";
  if (!fs::is_directory(folder)) GTEST_SKIP() << folder << " is not there";
  const YorkFolder york = ReadYorkFolder(folder.string());
  VpErrors errors;
  for (const YorkImage& image : york.images) {
    const auto segments =
        ExtractLines(DecodeGrey(image.file).grey, york.camera, LineExtractorOptions());
    errors.Add(EstimateVanishingPoints(segments, york.camera, VpOptions()).cam_from_manhattan,
               image.truth);
  }
  EXPECT_GT(errors.AA(3), 74);
  EXPECT_GT(errors.AA(5), 84);
  EXPECT_GT(errors.AA(10), 92);
  EXPECT_LT(errors.MedianRotation_deg(), 0.8);
  EXPECT_EQ(errors.ShareOver5_percent(), 0);
}

}  // namespace
}  // namespace vpslam
