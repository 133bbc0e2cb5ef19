#include "core/base/camera_file.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace vpslam {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

constexpr const char* kGood =
    "width: 640\nheight: 480\nfx: 522.4\nfy: 521.6\ncx: 318.7\ncy: 241.3\n";

class CameraFile : public ::testing::Test {
 protected:
  CameraFile()
      : path_(fs::temp_directory_path() / fmt::format("vpslam_camera_{}.yaml", getpid())) {}
  ~CameraFile() override { fs::remove(path_); }

  Camera Read(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return ReadCameraFile(path_.string());
  }
  /// The line of the error that reading ends with; empty if it does not.
  std::string Error(const std::string& text) {
    try {
      Read(text);
    } catch (const std::runtime_error& e) {
      EXPECT_THAT(e.what(), AllOf(HasSubstr(path_.string()), ::testing::Not(HasSubstr("\n"))));
      return e.what();
    }
    return {};
  }

  const fs::path path_;
};

TEST_F(CameraFile, ReadsWhatPeopleWrite) {
  EXPECT_EQ(Read(kGood).fx, 522.4);
  EXPECT_EQ(Read(kGood).fps, 30);
  EXPECT_EQ(Read(std::string(kGood) + "k1 : -0.28  # radial\nfps: 25\n").k1, -0.28);
  EXPECT_EQ(Read("%YAML:1.0\n---\n" + std::string(kGood)).cy, 241.3);
  EXPECT_EQ(Read("\xEF\xBB\xBF" + std::string(kGood)).width, 640);
  EXPECT_EQ(Read("width: 640.0\nheight: 4.8e2\nfx: 500\nfy: 500\ncx: 320\ncy: 240\n").height, 480);
}

TEST_F(CameraFile, RefusesKeysThatItDoesNotKnow) {
  for (const char* line : {"K1: -0.28", "kl: 0.07", "distortion: [-0.28, 0.07, 0, 0]",
                           "model: KannalaBrandt8", "p_1: 0.001", "xi: 1.2", "skew: 0"}) {
    const std::string key = std::string(line).substr(0, std::string(line).find(':'));
    EXPECT_THAT(Error(kGood + std::string(line) + "\n"),
                AllOf(HasSubstr("line 7"), HasSubstr("'" + key + "'"), HasSubstr("k1, k2")));
  }
  EXPECT_THAT(Error(std::string(kGood) + "k1: 5\nk4: 5.45\n"),
              AllOf(HasSubstr("k4"), HasSubstr("rational")));
  EXPECT_THAT(Error(std::string(kGood) + "fx: 300\n"),
              AllOf(HasSubstr("line 7"), HasSubstr("twice")));
}

TEST_F(CameraFile, NamesTheFilesOfOtherPrograms) {
  EXPECT_THAT(Error("%YAML:1.0\nCamera.fx: 522.4\n"), HasSubstr("ORB-SLAM"));
  EXPECT_THAT(Error("image_width: 640\ncamera_matrix:\n  rows: 3\n"), HasSubstr("ROS"));
  EXPECT_THAT(Error("cam0:\n  camera_model: pinhole\n"), HasSubstr("Kalibr"));
  EXPECT_THAT(Error("resolution: [640, 480]\nintrinsics: [1, 2, 3, 4]\n"), HasSubstr("EuRoC"));
  EXPECT_THAT(Error("1 OPENCV 640 480 522.4\n"), HasSubstr("key: value"));
  EXPECT_THAT(Error(""), HasSubstr("key: value"));
}

TEST_F(CameraFile, RefusesNumbersThatAreNone) {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = kGood;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_THAT(Error(with("522.4", "522,4")), AllOf(HasSubstr("line 3"), HasSubstr("not a number")));
  EXPECT_THAT(Error(with("640", "640.5")), AllOf(HasSubstr("line 1"), HasSubstr("whole number")));
  EXPECT_THAT(Error(with("640", ".nan")), HasSubstr("whole number"));
  EXPECT_THAT(Error(with("522.4", ".nan")), HasSubstr("finite"));
  EXPECT_THAT(Error(with("fy: 521.6\n", "")), HasSubstr("'fy' is missing"));
  EXPECT_THAT(Error(kGood + std::string("fps: 0\n")), HasSubstr("fps"));
}

TEST_F(CameraFile, RefusesLensesThatCannotBe) {
  EXPECT_THAT(Error("width: 640\nheight: 480\nfx: 0.816\nfy: 1.087\ncx: 0.498\ncy: 0.503\n"),
              AllOf(HasSubstr("fx is 0.816"), HasSubstr("180 degrees")));
  EXPECT_THAT(Error("width: 640\nheight: 480\nfx: 4.2\nfy: 4.2\ncx: 320\ncy: 240\n"),
              HasSubstr("mm"));
  EXPECT_THAT(Error("width: 640\nheight: 480\nfx: 400\nfy: 40000\ncx: 320\ncy: 240\n"),
              HasSubstr("factor of 100"));
  EXPECT_THAT(Error("width: 640\nheight: 480\nfx: 500\nfy: 500\ncx: 0.5\ncy: 0.5\n"),
              HasSubstr("corner"));
  // Of a fit to something else: the image folds over near its middle.
  EXPECT_THAT(Error(kGood + std::string("k1: -9\n")),
              AllOf(HasSubstr("% of the image"), HasSubstr("fit")));
}

}  // namespace
}  // namespace vpslam
