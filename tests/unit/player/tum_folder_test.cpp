#include "player/tum_folder.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "player/source_factory.h"
#include "tests/unit/player/sequence_folder.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

/// Frame i has the grey value 10 + i.
class TumFolder : public SequenceFolderTest {
 protected:
  void SetUp() override {
    SequenceFolderTest::SetUp();
    fs::create_directories(folder_ / "rgb");
    Write("camera.yaml", kSmallCamera);
  }
  static std::string Name(int i, const char* ending = "png") {
    return fmt::format("rgb/{:04}.{}", i, ending);
  }
  void WriteSequence(int n) {
    std::string list = "# timestamp filename\n";
    for (int i = 0; i < n; ++i) {
      WriteImage(Name(i), 10 + i);
      list += fmt::format("{:.6f} {}\n", i / 30.0, Name(i));
    }
    Write("rgb.txt", list);
  }
};

TEST_F(TumFolder, PlaysImagesInOrder) {
  WriteSequence(5);
  const auto frames = PlayAll();
  ASSERT_EQ(frames.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(frames[i].stamp_us, std::llround(i * 1e6 / 30));
    EXPECT_EQ(frames[i].grey.type(), CV_8UC1);
    EXPECT_EQ(frames[i].grey.size(), cv::Size(64, 48));
    EXPECT_EQ(frames[i].grey.at<uint8_t>(7, 6), 10 + i);
    EXPECT_GT(frames[i].decode_ms, 0);
  }
  EXPECT_EQ(Open()->camera().fy, 61);
  EXPECT_FALSE(Open()->WorldFromCam(0));
  EXPECT_TRUE(told_.empty());
  EXPECT_TRUE(summary_.empty());
}

TEST_F(TumFolder, TakesColourForGrey) {
  const cv::Mat colour(48, 64, CV_8UC3, cv::Scalar(50, 100, 200));  // blue, green, red
  ASSERT_TRUE(cv::imwrite((folder_ / "rgb/a.png").string(), colour));
  Write("rgb.txt", "0 rgb/a.png\n");
  const auto frames = PlayAll();
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_NEAR(frames[0].grey.at<uint8_t>(5, 5), 0.299 * 200 + 0.587 * 100 + 0.114 * 50, 1.5);
}

TEST_F(TumFolder, ReadsCommentsBlanksAndForeignLineEnds) {
  WriteImage("rgb/a b.png", 20);
  WriteImage("rgb/c.png", 30);
  Write("rgb.txt", "# one\r\n\r\n  1305031229.528748\t rgb/a b.png \r\n#\n1305031230 rgb/c.png");
  const auto frames = PlayAll();
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[0].stamp_us, 1305031229528748);
  EXPECT_EQ(frames[1].stamp_us, 1305031230000000);
}

TEST_F(TumFolder, StartsLaterAndStopsEarlier) {
  WriteSequence(6);
  options_.start = 2;
  options_.max_frames = 3;
  const auto frames = PlayAll();
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames.front().grey.at<uint8_t>(0, 0), 12);
  EXPECT_EQ(frames.back().grey.at<uint8_t>(0, 0), 14);
  options_.start = 6;
  EXPECT_THAT(Error(), AllOf(HasSubstr("rgb.txt"), HasSubstr("6 images"), HasSubstr("earlier")));
  options_.start = -1;
  EXPECT_THAT(Error(), HasSubstr("negative"));
}

TEST_F(TumFolder, GivesTheTruth) {
  WriteSequence(2);
  Write("groundtruth.txt",
        "# t x y z q\n0.001 1 2 3 0 0 0 2\n0.030 4 5 6 0 0 0.70710678 0.70710678\nnonsense\n");
  const auto source = Open();
  EXPECT_EQ(source->WorldFromCam(0)->translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(source->WorldFromCam(0)->rotation.norm(), 1, 1e-12);
  EXPECT_NEAR(
      (*source->WorldFromCam(33'333) * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(4, 6, 6)).norm(),
      0, 1e-6);
  EXPECT_FALSE(source->WorldFromCam(100'000));
  EXPECT_THAT(told_,
              ::testing::ElementsAre(AllOf(HasSubstr("groundtruth.txt:4"), HasSubstr("1 of 3"))));
}

TEST_F(TumFolder, SkipsRepeatedAndBackwardStamps) {
  std::string list;
  for (int i = 0; i < 6; ++i) WriteImage(Name(i), 10 + i);
  const char* stamps[] = {"0", "0.1", "0.1", "0.05", "0.1", "0.2"};
  for (int i = 0; i < 6; ++i) list += fmt::format("{} {}\n", stamps[i], Name(i));
  Write("rgb.txt", list);
  const auto frames = PlayAll();
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].stamp_us, 0);
  EXPECT_EQ(frames[1].grey.at<uint8_t>(0, 0), 11);
  EXPECT_EQ(frames[2].grey.at<uint8_t>(0, 0), 15);
  EXPECT_THAT(told_, ::testing::ElementsAre(AllOf(HasSubstr(Name(2)), HasSubstr("repeated")),
                                            AllOf(HasSubstr(Name(3)), HasSubstr("backward"))));
  EXPECT_THAT(summary_, AllOf(HasSubstr("2 repeated"), HasSubstr("1 backward")));
}

TEST_F(TumFolder, SkipsSingleBadFrames) {
  WriteSequence(100);
  fs::remove(folder_ / Name(10));
  Truncate(Name(20), 0.6);
  Write(Name(30), "");
  Write(Name(40), "no image at all");
  WriteImage(Name(50), 60, 48, 64);
  const auto frames = PlayAll();
  EXPECT_EQ(frames.size(), 95u);
  ASSERT_THAT(told_, SizeIs(5));
  for (int i = 0; i < 5; ++i) EXPECT_THAT(told_[i], HasSubstr(Name(10 * (i + 1))));
  EXPECT_THAT(told_[0], HasSubstr("missing"));
  EXPECT_THAT(told_[1], HasSubstr("truncated"));
  EXPECT_THAT(told_[2], HasSubstr("empty"));
  EXPECT_THAT(told_[4], AllOf(HasSubstr("48 x 64"), HasSubstr("64 x 48")));
  EXPECT_THAT(summary_, AllOf(HasSubstr("5 bad"), HasSubstr("95 images")));
}

TEST_F(TumFolder, NoticesATruncatedJpeg) {
  std::string list;
  cv::Mat noise(48, 64, CV_8UC1);
  cv::theRNG().state = 1;
  cv::randu(noise, 0, 255);
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(cv::imwrite((folder_ / Name(i, "jpg")).string(), noise));
    list += fmt::format("{} {}\n", i, Name(i, "jpg"));
  }
  Write("rgb.txt", list);
  Truncate(Name(10, "jpg"), 0.9);
  Truncate(Name(20, "jpg"), 0.2);
  std::ofstream(folder_ / Name(30, "jpg"), std::ios::app) << "junk behind the end is harmless";
  EXPECT_EQ(PlayAll().size(), 58u);
  ASSERT_THAT(told_, SizeIs(2));
  EXPECT_THAT(told_[0], AllOf(HasSubstr(Name(10, "jpg")), HasSubstr("truncated")));
  EXPECT_THAT(told_[1], AllOf(HasSubstr(Name(20, "jpg")), HasSubstr("truncated")));
}

TEST_F(TumFolder, GivesUpOnTooManyBadFrames) {
  WriteSequence(60);
  for (int i = 1; i <= 4; ++i) fs::remove(folder_ / Name(10 * i));
  EXPECT_THAT(Error(), AllOf(HasSubstr(Name(40)), HasSubstr("4 of 60"), HasSubstr("correct")));
}

TEST_F(TumFolder, GivesUpOnACalibrationOfAnotherSize) {
  WriteSequence(100);
  Write("other.yaml", "width: 640\nheight: 480\nfx: 60\nfy: 61\ncx: 31.5\ncy: 23.5\n");
  options_.camera_file = (folder_ / "other.yaml").string();
  EXPECT_THAT(Error(), AllOf(HasSubstr(Name(2)), HasSubstr("64 x 48"), HasSubstr("640 x 480"),
                             HasSubstr("other.yaml"), HasSubstr("--camera")));
}

TEST_F(TumFolder, RefusesWhatIsNoSequence) {
  EXPECT_THAT(Error(), AllOf(HasSubstr(folder_.string()), HasSubstr("rgb.txt")));
  Write("rgb.txt", "# only a comment\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("rgb.txt"), HasSubstr("lists no image")));
  Write("rgb.txt", "rgb/0000.png\nrgb/0001.png\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("rgb.txt:1"), HasSubstr("2 of 2")));
  Write("rgb.txt", "nan rgb/0000.png\n");
  EXPECT_THAT(Error(), HasSubstr("rgb.txt:1"));
  EXPECT_THROW(OpenSource((folder_ / "nowhere").string(), options_), std::runtime_error);
}

TEST_F(TumFolder, RefusesABadCalibration) {
  WriteSequence(3);
  fs::remove(folder_ / "camera.yaml");
  EXPECT_THAT(Error(), AllOf(HasSubstr("camera.yaml"), HasSubstr("--camera")));
  Write("camera.yaml", "width: 64\nheight: 48\nfx: .nan\nfy: 61\ncx: 31.5\ncy: 23.5\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("camera.yaml"), HasSubstr("finite")));
}

TEST(RealSequences, OpenAndPlay) {
  const char* given = std::getenv("VPSLAM_SHARED_DATA");
  const fs::path data = given ? fs::path(given) : fs::path(VPSLAM_SOURCE_DIR) / "../shared/data";
  if (!fs::is_directory(data)) GTEST_SKIP() << "no real sequences at " << data;
  int sequences = 0;
  for (const auto& entry : fs::directory_iterator(data)) {
    if (!fs::exists(entry.path() / "rgb.txt")) continue;
    ++sequences;
    SourceOptions options;
    options.max_frames = 3;
    options.tell = [](const std::string& line) { ADD_FAILURE() << line; };
    const auto source = OpenSource(entry.path().string(), options);
    int64_t frames = 0;
    while (source->Next()) ++frames;
    EXPECT_EQ(frames, 3) << entry.path();
  }
  EXPECT_GT(sequences, 0) << data;
}

}  // namespace
}  // namespace vpslam
