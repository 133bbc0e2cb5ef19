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

TEST_F(DecodeImage, StretchesWhatDoesNotFillSixteenBits) {
  for (const int bits : {10, 12, 14, 16}) {
    const int most = (1 << bits) - 1;
    cv::Mat ramp(48, 64, CV_16UC1);
    for (int i = 0; i < 48 * 64; ++i) {
      ramp.at<uint16_t>(i / 64, i % 64) = static_cast<uint16_t>(i * most / (48 * 64 - 1));
    }
    for (const char* name : {"ramp.png", "ramp.tiff", "ramp.pgm"}) {
      const std::string path = Write(name, ramp);
      const DeepPixels deep = LookForDeepPixels({Write("shallow.png", noise_), path});
      EXPECT_EQ(deep.path, path);
      EXPECT_EQ(deep.range.low, 0);
      EXPECT_EQ(deep.range.high, most);
      const cv::Mat grey = DecodeGrey(path, deep.range).grey;
      ASSERT_EQ(grey.type(), CV_8UC1);
      for (int i = 0; i < 48 * 64; i += 7) {
        EXPECT_NEAR(grey.at<uint8_t>(i / 64, i % 64), i * 255.0 / (48 * 64 - 1), 1) << bits;
      }
    }
  }
  EXPECT_EQ(LookForDeepPixels({Write("shallow.png", noise_)}).path, "");
}

TEST_F(DecodeImage, StretchesThermalImagesToTheirContent) {
  cv::Mat thermal(48, 64, CV_16UC1);
  cv::randu(thermal, 7000, 7400);
  const std::string path = Write("thermal.png", thermal);
  const GreyRange range = LookForDeepPixels({path}).range;
  EXPECT_NEAR(range.low, 7000 - 40, 5);
  EXPECT_NEAR(range.high, 7400 + 40, 5);
  cv::Scalar mean, deviation;
  cv::meanStdDev(DecodeGrey(path, range).grey, mean, deviation);
  EXPECT_NEAR(mean[0], 127.5, 5);
  EXPECT_GT(deviation[0], 50);
}

TEST_F(DecodeImage, OneHotPixelDoesNotDarkenAll) {
  cv::Mat image(480, 640, CV_16UC1);
  cv::randu(image, 0, 1024);
  image.at<uint16_t>(100, 100) = 65535;
  EXPECT_EQ(LookForDeepPixels({Write("hot.png", image)}).range.high, 1023);
}

TEST_F(DecodeImage, ObeysTheMaxvalOfAPgm) {
  const auto write = [&](const char* name, const std::string& bytes) {
    std::ofstream(Path(name), std::ios::binary) << bytes;
    return Path(name);
  };
  const auto values = [](const cv::Mat& grey) {
    return std::vector<int>(grey.begin<uint8_t>(), grey.end<uint8_t>());
  };
  const std::vector<int> expected = {0, 64, 128, 255};
  const std::string twelve = std::string("\0\0", 2) + "\x04\x04" + "\x08\x08" + "\x0F\xFF";
  EXPECT_EQ(values(DecodeGrey(write("a.pgm", "P5\n# 12 bits\n4 1\n4095\n" + twelve)).grey),
            expected);
  EXPECT_EQ(
      values(DecodeGrey(write("b.pgm", std::string("P5 4 1 63\n\0\x10\x20\x3F", 14))).grey)[3],
      255);
  EXPECT_EQ(values(DecodeGrey(write("c.pgm", "P2\n4 1\n4095\n0 1028 2056 4095\n")).grey), expected);
  EXPECT_EQ(values(DecodeGrey(write("d.pgm", "P2\n4 1\n63\n0 16 32 63\n")).grey)[3], 255);
  EXPECT_EQ(LookForDeepPixels({Path("a.pgm")}).range.high, 4095);
}

TEST_F(DecodeImage, RefusesFloatingPointByName) {
  cv::Mat floating(48, 64, CV_32FC1);
  cv::randu(floating, 0, 1);
  EXPECT_THAT(DecodeGrey(Write("float.tiff", floating)).fault,
              ::testing::HasSubstr("floating-point"));
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
