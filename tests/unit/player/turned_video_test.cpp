// A phone writes how it was held into a video, and the pixels as its sensor has them: those are
// played, as the calibration is of the sensor.
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "tests/unit/player/sequence_folder.h"

namespace vpslam {
namespace {

using TurnedVideo = SequenceFolderTest;

/// Writes the matrix of a quarter turn into the head of an MP4 file's track.
bool TurnByAQuarter(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  const auto head = bytes.find("tkhd");
  // Version and flags, times, id, reserved, duration, reserved, layer, group, volume: 40 bytes.
  if (head == std::string::npos || bytes[head + 4] != 0) return false;
  const auto put = [&](int element, uint32_t value) {
    for (std::size_t i = 0; i < 4; ++i) {
      bytes[head + 4 + 40 + 4 * static_cast<std::size_t>(element) + i] =
          static_cast<char>(value >> (24 - 8 * i));
    }
  };
  const uint32_t one = 1 << 16;
  put(0, 0), put(1, one), put(3, 0u - one), put(4, 0);
  std::ofstream(path, std::ios::binary) << bytes;
  return true;
}

TEST_F(TurnedVideo, IsPlayedAsTheSensorSawIt) {
  Write("camera.yaml", kSmallCamera);
  const std::string path = (folder_ / "clip.mp4").string();
  {
    cv::VideoWriter writer(path, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 25, {64, 48});
    if (!writer.isOpened()) GTEST_SKIP() << "no encoder for MPEG-4 here";
    cv::Mat image(48, 64, CV_8UC3, cv::Scalar::all(40));
    cv::rectangle(image, {0, 0}, {63, 23}, cv::Scalar::all(200), cv::FILLED);
    for (int i = 0; i < 5; ++i) writer.write(image);
  }
  ASSERT_TRUE(TurnByAQuarter(path));
  cv::Mat turned;
  ASSERT_TRUE(cv::VideoCapture(path).read(turned));
  ASSERT_EQ(turned.size(), cv::Size(48, 64)) << "others obey the matrix";

  options_.camera_file = (folder_ / "camera.yaml").string();
  const auto frame = OpenSource(path, options_)->Next();
  ASSERT_TRUE(frame);
  ASSERT_EQ(frame->grey.size(), cv::Size(64, 48));
  EXPECT_GT(frame->grey.at<uint8_t>(8, 32), 150) << "the bright half is above";
  EXPECT_LT(frame->grey.at<uint8_t>(40, 32), 90);
}

}  // namespace
}  // namespace vpslam
