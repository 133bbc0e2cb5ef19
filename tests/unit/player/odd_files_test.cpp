// The files of tests/unit/odd_files.json, which Python's readers are tried on as well.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "player/folder_reading.h"
#include "player/text_lines.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

nlohmann::json Table() {
  return nlohmann::json::parse(
      std::ifstream(fs::path(VPSLAM_SOURCE_DIR) / "tests" / "unit" / "odd_files.json"));
}

/// The file of an entry, while it lives.
class OddFile {
 public:
  explicit OddFile(const nlohmann::json& entry)
      : path_(fs::temp_directory_path() / fmt::format("vpslam_odd_file_{}.txt", getpid())) {
    std::string text = entry["text"];
    if (entry.value("utf16", false)) {
      std::string wide = "\xFF\xFE";
      for (const char c : text) wide += {c, '\0'};
      text = wide;
    }
    std::ofstream(path_, std::ios::binary) << text;
  }
  ~OddFile() { fs::remove(path_); }
  std::string path() const { return path_.string(); }

 private:
  fs::path path_;
};

/// Time stamps in order, us, or what is wrong with the file.
template <class Parse>
std::string ReadStamps(const std::string& path, const Parse& parse, std::vector<int64_t>* stamps) {
  try {
    const LineCounts counts = ReadLines(path, [&](std::string_view line, const LinePlace& place) {
      int64_t stamp_us = 0;
      std::string fault = parse(line, place.index, &stamp_us);
      if (fault.empty()) stamps->push_back(stamp_us);
      return fault;
    });
    std::sort(stamps->begin(), stamps->end());
    return counts.refused > 0 ? counts.Describe(path) : std::string();
  } catch (const std::runtime_error& e) {
    return e.what();
  }
}

template <class Parse>
void Check(const nlohmann::json& entries, const Parse& parse) {
  ASSERT_GT(entries.size(), 10u);
  for (const auto& entry : entries) {
    SCOPED_TRACE(entry["name"]);
    const OddFile file(entry);
    std::vector<int64_t> stamps;
    const std::string fault = ReadStamps(file.path(), parse, &stamps);
    if (entry.contains("fault")) {
      EXPECT_THAT(fault, ::testing::HasSubstr(entry["fault"].get<std::string>()));
      EXPECT_TRUE(stamps.empty());
      continue;
    }
    EXPECT_EQ(fault, "");
    const auto expected_s = entry["stamps_s"].get<std::vector<double>>();
    ASSERT_EQ(stamps.size(), expected_s.size());
    for (size_t i = 0; i < stamps.size(); ++i) {
      EXPECT_NEAR(static_cast<double>(stamps[i]), 1e6 * expected_s[i], 1);
    }
  }
}

TEST(OddFiles, ListsAreReadOrRefusedByName) {
  Check(Table()["lists"], [](std::string_view line, int64_t, int64_t* stamp_us) {
    ListedImage image;
    std::string fault = ParseSecondsAndFile(line, "/nowhere", &image);
    *stamp_us = image.stamp_us;
    return fault;
  });
}

TEST(OddFiles, TrajectoriesAreReadOrRefusedByName) {
  Check(Table()["trajectories"], [](std::string_view line, int64_t index, int64_t* stamp_us) {
    StampedPose pose;
    std::string fault = ParseTumLine(line, index, &pose);
    *stamp_us = pose.first;
    return fault;
  });
}

}  // namespace
}  // namespace vpslam
