// A folder that a test fills with a small sequence, 64 x 48 px, and plays.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <unistd.h>

#include "player/source_factory.h"

namespace vpslam {

inline constexpr const char* kSmallCamera =
    "width: 64\nheight: 48\nfx: 60\nfy: 61\ncx: 31.5\ncy: 23.5\n";

class SequenceFolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::temp_directory_path() /
              fmt::format("vpslam_{}_{}_{}", test->test_suite_name(), test->name(), getpid());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    options_.tell = [this](const std::string& line) { told_.push_back(line); };
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void Write(const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  /// Columns alternate between `grey` and the next value.
  void WriteImage(const std::string& name, int grey, int width = 64, int height = 48) {
    cv::Mat image(height, width, CV_8UC1);
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) image.at<uint8_t>(v, u) = static_cast<uint8_t>(grey + u % 2);
    }
    std::filesystem::create_directories((folder_ / name).parent_path());
    ASSERT_TRUE(cv::imwrite((folder_ / name).string(), image));
  }
  void Truncate(const std::string& name, double fraction) {
    const auto size = std::filesystem::file_size(folder_ / name);
    std::filesystem::resize_file(folder_ / name,
                                 static_cast<uintmax_t>(fraction * static_cast<double>(size)));
  }
  std::unique_ptr<ImageSource> Open() { return OpenSource(folder_.string(), options_); }
  std::vector<SourceFrame> PlayAll() {
    const auto source = Open();
    std::vector<SourceFrame> frames;
    while (auto frame = source->Next()) frames.push_back(std::move(*frame));
    report_ = source->Report();
    return frames;
  }
  /// The line of the error that playing ends with; empty if it does not.
  std::string Error() {
    try {
      PlayAll();
    } catch (const std::runtime_error& e) {
      EXPECT_THAT(e.what(), ::testing::Not(::testing::HasSubstr("\n")));
      return e.what();
    }
    return {};
  }

  std::filesystem::path folder_;
  SourceOptions options_;
  std::vector<std::string> told_;
  SourceReport report_;
};

}  // namespace vpslam
