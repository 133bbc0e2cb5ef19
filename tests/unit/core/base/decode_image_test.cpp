#include "core/base/decode_image.h"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

namespace vpslam {
namespace {

namespace fs = std::filesystem;

class DecodeImage : public ::testing::Test {
 protected:
  DecodeImage() {
    cv::theRNG().state = 1;
    noise_ = cv::Mat(48, 64, CV_8UC1);
    cv::randu(noise_, 0, 255);
  }
  void SetUp() override {
    folder_ = fs::temp_directory_path() / fmt::format("vpslam_decode_image_{}", getpid());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string Path(const char* name) const { return (folder_ / name).string(); }
  std::string Write(const char* name, const cv::Mat& image) const {
    EXPECT_TRUE(cv::imwrite(Path(name), image));
    return Path(name);
  }
  static void Truncate(const std::string& path, double fraction) {
    fs::resize_file(path,
                    static_cast<uintmax_t>(fraction * static_cast<double>(fs::file_size(path))));
  }

  fs::path folder_;
  cv::Mat noise_;
};

TEST_F(DecodeImage, ReadsGreyAsItIs) {
  for (const char* name : {"a.png", "a.pgm", "a.bmp", "a.tiff"}) {
    const DecodedImage image = DecodeGrey(Write(name, noise_));
    EXPECT_EQ(image.fault, "") << name;
    ASSERT_EQ(image.grey.type(), CV_8UC1) << name;
    EXPECT_EQ(cv::norm(image.grey, noise_, cv::NORM_INF), 0) << name;
  }
}

TEST_F(DecodeImage, MakesColourAndSixteenBitsGrey) {
  const cv::Mat colour(48, 64, CV_8UC3, cv::Scalar(50, 100, 200));  // blue, green, red
  const DecodedImage from_colour = DecodeGrey(Write("colour.png", colour));
  ASSERT_EQ(from_colour.grey.type(), CV_8UC1);
  EXPECT_NEAR(from_colour.grey.at<uint8_t>(5, 5), 0.299 * 200 + 0.587 * 100 + 0.114 * 50, 1.5);

  const DecodedImage from_16 =
      DecodeGrey(Write("deep.png", cv::Mat(48, 64, CV_16UC1, cv::Scalar(0x8070))));
  ASSERT_EQ(from_16.grey.type(), CV_8UC1);
  EXPECT_EQ(from_16.grey.at<uint8_t>(5, 5), 0x80);
}

TEST_F(DecodeImage, TellsWhatIsWrong) {
  EXPECT_EQ(DecodeGrey(Path("nowhere.png")).fault, "is missing or cannot be opened");
  EXPECT_EQ(DecodeGrey(Path(".")).fault, "is a folder");
  std::ofstream(Path("empty.png")).close();
  EXPECT_EQ(DecodeGrey(Path("empty.png")).fault, "is empty");
  std::ofstream(Path("text.png")) << "no image at all";
  EXPECT_EQ(DecodeGrey(Path("text.png")).fault, "is truncated or no image");
}

TEST_F(DecodeImage, NoticesTruncatedFiles) {
  for (const char* name : {"a.png", "a.jpg"}) {
    for (const double fraction : {0.2, 0.9, 0.999}) {
      const std::string path = Write(name, noise_);
      Truncate(path, fraction);
      const DecodedImage image = DecodeGrey(path);
      EXPECT_THAT(image.fault, ::testing::StartsWith("is truncated")) << name << " " << fraction;
      EXPECT_TRUE(image.grey.empty());
    }
  }
}

TEST_F(DecodeImage, IsNotMisledByAThumbnailsEnd) {
  const std::string path = Write("a.jpg", noise_);
  std::ifstream in(path, std::ios::binary);
  std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  // An application segment of 6 bytes, length included, that holds an end-of-image marker.
  const char segment[] = {'\xFF', '\xE1', 0, 6, '\xFF', '\xD9', 0, 0};
  bytes.insert(bytes.begin() + 2, std::begin(segment), std::end(segment));
  const auto write = [&](size_t n) {
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(n));
  };
  write(bytes.size());
  EXPECT_EQ(DecodeGrey(path).fault, "");
  write(bytes.size() * 9 / 10);
  EXPECT_EQ(DecodeGrey(path).fault, "is truncated");
}

TEST_F(DecodeImage, AllowsJunkBehindTheEnd) {
  const std::string path = Write("a.jpg", noise_);
  std::ofstream(path, std::ios::app) << "junk behind the end is harmless";
  EXPECT_EQ(DecodeGrey(path).fault, "");
}

}  // namespace
}  // namespace vpslam
