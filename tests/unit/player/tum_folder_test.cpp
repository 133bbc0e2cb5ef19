#include "player/tum_folder.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <random>
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
  EXPECT_EQ(report_.expected, 5);
  EXPECT_TRUE(report_.skipped.empty());
  EXPECT_TRUE(report_.notes.empty());
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
  EXPECT_THAT(source->Report().notes,
              ::testing::ElementsAre(AllOf(HasSubstr("groundtruth.txt:4"), HasSubstr("1 of 3"))));
}

/// As above, with the stamps of a list that somebody wrote.
class TumStamps : public TumFolder {
 protected:
  void WriteStamps(const std::vector<double>& stamps_s, const char* format = "{:.6f}") {
    std::string list = "# timestamp filename\n";
    for (size_t i = 0; i < stamps_s.size(); ++i) {
      WriteImage(Name(static_cast<int>(i)), 10 + static_cast<int>(i));
      list +=
          fmt::format(fmt::runtime(format), stamps_s[i]) + " " + Name(static_cast<int>(i)) + "\n";
    }
    Write("rgb.txt", list);
  }
  static std::vector<double> Even(int n) {
    std::vector<double> stamps;
    for (int i = 0; i < n; ++i) stamps.push_back(100 + i / 30.0);
    return stamps;
  }
  /// The images that are played, by number; stamps have to ascend.
  std::vector<int> Played() {
    std::vector<int> numbers;
    int64_t last_us = std::numeric_limits<int64_t>::min();
    for (const SourceFrame& frame : PlayAll()) {
      EXPECT_GT(frame.stamp_us, last_us);
      last_us = frame.stamp_us;
      numbers.push_back(frame.grey.at<uint8_t>(0, 0) - 10);
    }
    return numbers;
  }
};

TEST_F(TumStamps, AShuffledListIsSorted) {
  auto stamps = Even(40);
  std::shuffle(stamps.begin(), stamps.end(), std::mt19937(3));
  WriteStamps(stamps);
  const std::vector<int> played = Played();
  ASSERT_THAT(played, SizeIs(40));
  for (size_t i = 1; i < played.size(); ++i) EXPECT_LT(stamps[played[i - 1]], stamps[played[i]]);
  EXPECT_THAT(report_.notes, ::testing::ElementsAre(HasSubstr("was sorted")));
}

TEST_F(TumStamps, OneStampInTheFutureCostsOneImage) {
  for (const int wrong : {0, 20}) {
    auto stamps = Even(40);
    stamps[wrong] += 1e9;
    WriteStamps(stamps);
    EXPECT_THAT(Played(), AllOf(SizeIs(39), ::testing::Not(::testing::Contains(wrong))));
    EXPECT_EQ(report_.expected, 40);
    EXPECT_EQ(report_.skipped.at("time stamp out of place"), 1);
    fs::remove_all(folder_ / "rgb");
  }
}

TEST_F(TumStamps, AClockThatIsSetBackIsBridged) {
  auto stamps = Even(40);
  for (int i = 20; i < 40; ++i) stamps[i] -= 5;
  WriteStamps(stamps);
  Write("groundtruth.txt", fmt::format("{:.6f} 7 0 0 0 0 0 1\n", stamps[30]));
  const std::vector<int> played = Played();
  ASSERT_THAT(played, SizeIs(40));
  for (int i = 0; i < 40; ++i) EXPECT_EQ(played[i], i);
  EXPECT_THAT(report_.notes,
              ::testing::Contains(AllOf(HasSubstr("rgb.txt:22"), HasSubstr("set back"))));
  // The truth keeps to the stamps of the file.
  const auto source = Open();
  for (int i = 0; i < 30; ++i) source->Next();
  EXPECT_EQ(source->WorldFromCam(source->Next()->stamp_us)->translation.x(), 7);
}

TEST_F(TumStamps, ManyRepeatedStampsAreRefused) {
  WriteStamps(Even(40), "{:.0f}");
  EXPECT_THAT(Error(), AllOf(HasSubstr("rgb.txt:3"), HasSubstr("100.000000"), HasSubstr("rounded"),
                             HasSubstr("38 of 40")));
}

TEST_F(TumStamps, OtherUnitsAreNamed) {
  auto stamps = Even(40);
  for (double& stamp : stamps) stamp = (stamp - 100) * 1e3;
  WriteStamps(stamps, "{:.0f}");
  EXPECT_THAT(Error(), AllOf(HasSubstr("rgb.txt:3"), HasSubstr("are milliseconds"),
                             HasSubstr("camera.yaml has 30 Hz")));
  for (double& stamp : stamps) stamp *= 1e3;
  WriteStamps(stamps, "{:.0f}");
  EXPECT_THAT(Error(), HasSubstr("are microseconds"));
  for (int i = 0; i < 40; ++i) stamps[i] = i;
  WriteStamps(stamps, "{:.0f}");
  EXPECT_THAT(Error(), HasSubstr("are numbers of images"));
  Write("camera.yaml", std::string(kSmallCamera) + "fps: 1\n");  // which they are not then
  EXPECT_THAT(Played(), SizeIs(40));
}

TEST_F(TumStamps, LongGapsAreTold) {
  auto stamps = Even(40);
  for (int i = 10; i < 40; ++i) stamps[i] += 3600;
  WriteStamps(stamps);
  EXPECT_THAT(Played(), SizeIs(40));
  EXPECT_THAT(report_.notes,
              ::testing::ElementsAre(AllOf(HasSubstr("rgb.txt:12"), HasSubstr("3600 s"))));
}

TEST_F(TumStamps, ATruthThatMatchesNothingIsTold) {
  WriteStamps(Even(40));
  Write("groundtruth.txt", "1000 1 2 3 0 0 0 1\n1001 1 2 3 0 0 0 1\n");
  Played();
  EXPECT_THAT(report_.notes, ::testing::ElementsAre(AllOf(HasSubstr("0 of 40 images"),
                                                          HasSubstr("1000.000 to 1001.000 s"))));
  Write("groundtruth.txt", "100 1 2 3 0 0 0 1 0 0 0 0\n");
  Played();
  EXPECT_THAT(report_.notes, ::testing::Contains(HasSubstr("KITTI")));
}

TEST_F(TumStamps, SixteenBitsAreStretchedAsTheFirstImagesAre) {
  WriteStamps(Even(10));
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(cv::imwrite((folder_ / Name(i)).string(),
                            cv::Mat(48, 64, CV_16UC1, cv::Scalar(100 * i + 120))));
  }
  const auto frames = PlayAll();
  // Up to 1020: 10 bits.
  for (int i = 0; i < 10; ++i) {
    EXPECT_NEAR(frames[i].grey.at<uint8_t>(0, 0), (100 * i + 120) * 255.0 / 1023, 1) << i;
  }
  EXPECT_THAT(report_.notes,
              ::testing::ElementsAre(AllOf(HasSubstr("16-bit"), HasSubstr("0 to 1023"))));
}

TEST_F(TumStamps, TheListItselfCanBeNamed) {
  WriteStamps(Even(5));
  const auto source = OpenSource((folder_ / "rgb.txt").string(), options_);
  int frames = 0;
  while (source->Next()) ++frames;
  EXPECT_EQ(frames, 5);
  EXPECT_THROW(OpenSource((folder_ / "camera.yaml").string(), options_), std::runtime_error);
  EXPECT_THROW(OpenSource((folder_ / Name(0)).string(), options_), std::runtime_error);
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
  EXPECT_THAT(told_[0], AllOf(HasSubstr("rgb.txt:12"), HasSubstr("missing")));
  EXPECT_THAT(told_[1], AllOf(HasSubstr("rgb.txt:22"), HasSubstr("truncated")));
  EXPECT_THAT(told_[2], HasSubstr("empty"));
  EXPECT_THAT(told_[4], AllOf(HasSubstr("48 x 64"), HasSubstr("64 x 48")));
  EXPECT_EQ(report_.expected, 100);
  EXPECT_EQ(report_.skipped.at("is missing"), 1);
  EXPECT_EQ(report_.skipped.at("is truncated"), 1);
  EXPECT_EQ(report_.skipped.at("is of another size"), 1);
}

TEST_F(TumFolder, NoticesATruncatedJpeg) {
  std::string list;
  cv::Mat noise(48, 64, CV_8UC1);
  cv::theRNG().state = 1;
  cv::randu(noise, 0, 255);
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(cv::imwrite((folder_ / Name(i, "jpg")).string(), noise));
    list += fmt::format("{:.3f} {}\n", i / 30.0, Name(i, "jpg"));
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
  EXPECT_THAT(Error(), AllOf(HasSubstr(Name(10)), HasSubstr("4 of 60"), HasSubstr("correct")));
}

TEST_F(TumFolder, GivesUpOnACalibrationOfAnotherSize) {
  WriteSequence(100);
  Write("other.yaml", "width: 640\nheight: 480\nfx: 600\nfy: 610\ncx: 315\ncy: 235\n");
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
  Write("rgb.txt", "1,033 rgb/0000.png\n1,066 rgb/0001.png\n");
  EXPECT_THAT(Error(), HasSubstr("decimal comma"));
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
