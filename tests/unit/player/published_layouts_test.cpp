// Layouts of data sets that are like others but for a few files.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/unit/player/sequence_folder.h"

namespace vpslam {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class PublishedLayouts : public SequenceFolderTest {};

TEST_F(PublishedLayouts, SevenScenesPlaysTheColourImagesWithTheirPoses) {
  for (int i = 0; i < 4; ++i) {
    WriteImage(fmt::format("frame-{:06}.color.png", i), 10 + i);
    WriteImage(fmt::format("frame-{:06}.depth.png", i), 200);
    // Turned by 90 degrees about z; the third pose is one of those without numbers.
    Write(fmt::format("frame-{:06}.pose.txt", i),
          i == 2 ? "-inf -inf -inf -inf\n"
                 : fmt::format("0 -1 0 {}\t\n1 0 0 0\t\n0 0 1 0\t\n0 0 0 1\t\n", 0.5 * i));
  }
  EXPECT_THAT(Error(), AllOf(HasSubstr("camera.yaml"), HasSubstr("--camera")));
  Write("camera.yaml", kSmallCamera);
  const auto frames = PlayAll();
  ASSERT_EQ(frames.size(), 4u);
  const auto source = Open();
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(frames[i].grey.at<uint8_t>(0, 0), 10 + i);
    EXPECT_EQ(frames[i].stamp_us, std::llround(1e6 * i / 30));
    const auto truth = source->WorldFromCam(frames[i].stamp_us);
    ASSERT_EQ(truth.has_value(), i != 2);
    if (!truth) continue;
    EXPECT_NEAR((*truth * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0.5 * i, 1, 0)).norm(), 0,
                1e-9);
  }
}

TEST_F(PublishedLayouts, Eth3dHasItsCalibrationBesideTheList) {
  std::string list;
  for (int i = 0; i < 6; ++i) {
    WriteImage(fmt::format("rgb/{}.png", i), 10 + i);
    list += fmt::format("{:.6f} rgb/{}.png\n", 9000 + i / 27.1, i);
  }
  Write("rgb.txt", list);
  Write("calibration.txt", "60.5 61 31.5 23\n");
  Write("groundtruth.txt", "9000.0 1 2 3 0 0 0 1\n");
  EXPECT_EQ(PlayAll().size(), 6u);
  const auto source = Open();
  EXPECT_EQ(source->camera().fx, 60.5);
  EXPECT_EQ(source->camera().cy, 23);
  EXPECT_EQ(source->camera().width, 64);
  EXPECT_EQ(source->WorldFromCam(9'000'000'000)->translation, Eigen::Vector3d(1, 2, 3));
  Write("calibration.txt", "60.5 61 31.5\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("calibration.txt"), HasSubstr("fx fy cx cy")));
  Write("calibration.txt", "0.95 0.96 0.5 0.5\n");
  EXPECT_THAT(Error(), AllOf(HasSubstr("calibration.txt"), HasSubstr("degrees")));
}

TEST_F(PublishedLayouts, TartanAirHasPosesInAxesOfItsOwn) {
  for (int i = 0; i < 3; ++i) WriteImage(fmt::format("image_left/{:06}_left.png", i), 10 + i);
  // Moves north, then turns its nose to the east, about the axis that points down.
  Write("pose_left.txt", "0 0 0 0 0 0 1\n1 0 0 0 0 0 1\n1 0 0 0 0 0.70710678 0.70710678\n");
  const auto frames = PlayAll();
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[2].stamp_us, 200'000);
  const auto source = Open();
  EXPECT_EQ(source->camera().fx, 32);
  EXPECT_EQ(source->camera().cy, 24);
  const Eigen::Vector3d forward(0, 0, 1), down(0, 1, 0);
  EXPECT_NEAR((*source->WorldFromCam(100'000) * forward - Eigen::Vector3d(2, 0, 0)).norm(), 0,
              1e-6);
  EXPECT_NEAR((*source->WorldFromCam(100'000) * down - Eigen::Vector3d(1, 0, 1)).norm(), 0, 1e-6);
  EXPECT_NEAR((*source->WorldFromCam(200'000) * forward - Eigen::Vector3d(1, 1, 0)).norm(), 0,
              1e-6);
  options_.fps = 20;
  EXPECT_EQ(PlayAll()[2].stamp_us, 100'000);
}

TEST_F(PublishedLayouts, TumViHasTheMotionCaptureOfTheBody) {
  std::string list = "#timestamp [ns],filename\n";
  const int64_t first_ns = 1520531829251142058;
  for (int i = 0; i < 5; ++i) {
    const int64_t ns = first_ns + 50'000'000LL * i;
    WriteImage(fmt::format("mav0/cam0/data/{}.png", ns), 10 + i);
    list += fmt::format("{},{}.png\n", ns, ns);
  }
  Write("mav0/cam0/data.csv", list);
  Write("mav0/mocap0/data.csv",
        fmt::format("#timestamp [ns], p_RS_R_x [m], ...\n{},1,2,3,1,0,0,0\n", first_ns));
  const auto chain = [](const std::string& model) {
    return "cam0:\n  T_cam_imu:\n  - [1.0, 0.0, 0.0, 0.25]\n  - [0.0, 1.0, 0.0, 0.0]\n"
           "  - [0.0, 0.0, 1.0, 0.0]\n  - [0.0, 0.0, 0.0, 1.0]\n"
           "  camera_model: pinhole\n  distortion_model: " +
           model +
           "\n  distortion_coeffs: [0.0034, 0.0007, -0.002, 0.0002]\n"
           "  intrinsics: [60, 61, 31.5, 23.5]\n  resolution: [64, 48]\n";
  };
  Write("dso/camchain.yaml", chain("equidistant"));
  EXPECT_THAT(Error(),
              AllOf(HasSubstr("camchain.yaml"), HasSubstr("equidistant"), HasSubstr("undistort")));
  Write("dso/camchain.yaml", chain("radtan"));
  EXPECT_EQ(PlayAll().size(), 5u);
  EXPECT_EQ(Open()->camera().fx, 60);
  Write("dso/camchain.yaml", chain("equidistant"));
  Write("mine.yaml", kSmallCamera);
  options_.camera_file = (folder_ / "mine.yaml").string();
  const auto source = Open();
  // The camera is 0.25 m beside the body: x_cam = x_body + 0.25.
  EXPECT_NEAR(
      (source->WorldFromCam(first_ns / 1000)->translation - Eigen::Vector3d(0.75, 2, 3)).norm(), 0,
      1e-9);
}

TEST_F(PublishedLayouts, WhatIsNoSequenceIsNamed) {
  Write("image_0/readme", "x");
  EXPECT_THAT(Error(), HasSubstr("no times.txt"));
  std::filesystem::remove_all(folder_ / "image_0");
  WriteImage("left/0.png", 1);
  EXPECT_THAT(Error(), HasSubstr("left/ in it holds images"));
  std::filesystem::remove_all(folder_ / "left");
  Write("IMG_1.HEIC", "x");
  EXPECT_THAT(Error(), AllOf(HasSubstr(".HEIC"), HasSubstr("convert")));
  Write("run.bag", "#ROSBAG V2.0\nbinary \x01\x02");
  EXPECT_THROW(OpenSource((folder_ / "run.bag").string(), options_), std::runtime_error);
}

}  // namespace
}  // namespace vpslam
