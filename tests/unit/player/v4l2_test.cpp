// What the player asks of a camera and takes from it, on the stand-in of fake_v4l2.cpp, which CTest
// preloads.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <unistd.h>

#include "player/capture_clock.h"
#include "player/frame_capture.h"
#include "player/live_camera.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class V4l2Test : public ::testing::Test {
 protected:
  V4l2Test()
      : device_(fmt::format("/dev/shm/vpslam-camera-{}", getpid())),
        folder_(fs::temp_directory_path() / fmt::format("vpslam_v4l2_{}", getpid())) {
    std::ofstream(device_).put('x');  // it has to exist
    fs::create_directories(folder_);
    setenv("VPSLAM_FAKE_CAMERA", device_.c_str(), 1);
    const std::string jpeg = (folder_ / "picture.jpg").string();
    cv::imwrite(jpeg, cv::Mat(720, 1280, CV_8UC3, cv::Scalar(90, 90, 90)));
    setenv("VPSLAM_FAKE_JPEG", jpeg.c_str(), 1);
    std::ofstream(folder_ / "lens.yaml")
        << "width: 1280\nheight: 720\nfps: 30\nfx: 900\nfy: 900\ncx: 640\ncy: 360\n";
    options_.camera_file = (folder_ / "lens.yaml").string();
  }
  ~V4l2Test() override {
    for (const char* name : {"VPSLAM_FAKE_FORMATS", "VPSLAM_FAKE_SIZE", "VPSLAM_FAKE_STALL"}) {
      unsetenv(name);
    }
    fs::remove(device_);
    fs::remove_all(folder_);
  }
  std::unique_ptr<ImageSource> Open() { return OpenLiveCamera("camera:" + device_, options_); }
  std::string OpeningError() {
    try {
      Open();
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return {};
  }

  const std::string device_;
  const fs::path folder_;
  SourceOptions options_;
};

TEST_F(V4l2Test, IsAskedForMjpgBeforeSizeAndRate) {
  const auto camera = Open();
  EXPECT_EQ(camera->camera().fps, 30);
  EXPECT_EQ(camera->Notice(), device_ + " gives 1280 x 720 px at 30 Hz as MJPG");
  const auto frame = camera->Next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->grey.size(), cv::Size(1280, 720));
  EXPECT_NEAR(frame->grey.at<uint8_t>(300, 300), 90, 3);
}

TEST_F(V4l2Test, GivesAllPicturesThatItTakes) {
  const auto capture = OpenCapture(device_, {1280, 720, 30, ""});
  std::vector<int64_t> stamps;
  for (int i = 0; i < 25; ++i) stamps.push_back(capture->Read()->stamp_us);
  const double rate_hz = 24e6 / static_cast<double>(stamps.back() - stamps.front());
  EXPECT_GT(rate_hz, 20) << "three times what raw images come at; a busy machine may miss some";
}

TEST_F(V4l2Test, ThePicturesTimeIsTheDriversAndNotThatOfReading) {
  const auto capture = OpenCapture(device_, {640, 480, 30, "YUYV"});
  const SteadyWallClock clock;
  for (int i = 0; i < 3; ++i) {
    const int64_t stamp_us = capture->Read()->stamp_us;
    EXPECT_GE(clock.Now_us() - stamp_us, 29'000) << "the stand-in's pictures are 30 ms old";
  }
}

TEST_F(V4l2Test, ACameraWithoutMjpgIsTakenAsItIsAndThatIsTold) {
  setenv("VPSLAM_FAKE_FORMATS", "YUYV", 1);
  const auto camera = Open();
  EXPECT_EQ(camera->camera().fps, 10) << "as it comes, not as it was asked for";
  EXPECT_THAT(camera->Notice(), AllOf(HasSubstr("at 10 Hz as YUYV"), HasSubstr("not the 30 Hz"),
                                      HasSubstr("--pixel-format")));
  EXPECT_EQ(camera->Next()->grey.size(), cv::Size(1280, 720));
}

TEST_F(V4l2Test, APixelFormatThatWasAskedForIsTakenOrRefused) {
  options_.pixel_format = "YUYV";
  EXPECT_THAT(Open()->Notice(), HasSubstr("as YUYV"));
  options_.pixel_format = "MJPG";
  setenv("VPSLAM_FAKE_FORMATS", "YUYV", 1);
  EXPECT_THAT(OpeningError(),
              AllOf(HasSubstr("does not give MJPG, but YUYV"), HasSubstr("--pixel-format")));
  options_.pixel_format = "MJPEG";
  EXPECT_THAT(options_.Validate().value_or(""), HasSubstr("four letters"));
}

TEST_F(V4l2Test, AnotherSizeThanTheCalibrationsIsRefusedAtOnce) {
  setenv("VPSLAM_FAKE_SIZE", "640x480", 1);
  EXPECT_THAT(OpeningError(), AllOf(HasSubstr("gives 640 x 480 px, not the 1280 x 720"),
                                    HasSubstr("lens.yaml"), HasSubstr("--width")));
}

TEST_F(V4l2Test, OneThatDeliversNothingIsLeftBehind) {
  setenv("VPSLAM_FAKE_STALL", "1", 1);
  const auto start = std::chrono::steady_clock::now();
  {
    const auto camera = Open();
    EXPECT_FALSE(camera->WaitReady(std::chrono::milliseconds(100)));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

}  // namespace
}  // namespace vpslam
