#include "recorder/results_folder.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace vpslam {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class ResultsFolderTest : public ::testing::Test {
 protected:
  void SetUp() override {
    path_ = fs::temp_directory_path() /
            fmt::format("vpslam_results_{}_{}", getpid(),
                        ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(path_);
  }
  void TearDown() override { fs::remove_all(path_); }
  std::string Read(const std::string& name) const {
    std::ifstream file(path_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  int CountFiles() const {
    return static_cast<int>(std::distance(fs::directory_iterator(path_), {}));
  }

  fs::path path_;
};

TEST_F(ResultsFolderTest, WritesAndReplaces) {
  const ResultsFolder folder((path_ / "").string());
  EXPECT_EQ(CountFiles(), 0);
  folder.Write({{"a.txt", "one"}, {"b.txt", ""}});
  folder.Write({{"a.txt", "two"}});
  EXPECT_EQ(Read("a.txt"), "two");
  EXPECT_EQ(CountFiles(), 2);
}

TEST_F(ResultsFolderTest, RemovesTrajectoriesOfMapsThatAreNoMore) {
  const ResultsFolder folder(path_.string());
  folder.Write({{"trajectory_map2.txt", "x"}, {"trajectory_map3.txt", "x"}, {"notes.txt", "x"}});
  folder.RemoveStaleMaps({{"trajectory_map2.txt", "x"}});
  EXPECT_TRUE(fs::exists(path_ / "trajectory_map2.txt"));
  EXPECT_FALSE(fs::exists(path_ / "trajectory_map3.txt"));
  EXPECT_TRUE(fs::exists(path_ / "notes.txt"));
}

TEST_F(ResultsFolderTest, SaysWhyItCannotWrite) {
  std::ofstream(path_) << "a file where the folder should be";
  try {
    const ResultsFolder folder(path_.string());
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr(path_.string()));
    EXPECT_THAT(e.what(), HasSubstr("--out"));
  }
}

TEST_F(ResultsFolderTest, AFailureLeavesTheOldFile) {
  const ResultsFolder folder(path_.string());
  folder.Write({{"a.txt", "old"}});
  fs::create_directory(path_ / ".a.txt.tmp");  // a's temporary file cannot be made
  EXPECT_THROW(folder.Write({{"a.txt", "new"}}), std::runtime_error);
  EXPECT_EQ(Read("a.txt"), "old");
}

TEST_F(ResultsFolderTest, WhatDoesNotFitCostsNothingElse) {
  const ResultsFolder folder(path_.string());
  fs::create_directory(path_ / ".b.txt.tmp");  // b's temporary file cannot be made
  try {
    folder.Write({{"a.txt", "one"}, {"b.txt", "two"}, {"c.txt", "three"}});
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("cannot write b.txt (Is a directory); all other results"));
  }
  EXPECT_EQ(Read("a.txt"), "one");
  EXPECT_EQ(Read("c.txt"), "three");
}

TEST_F(ResultsFolderTest, NoticesAFullDisk) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const ResultsFolder folder(path_.string());
  fs::create_symlink("/dev/full", path_ / ".a.txt.tmp");
  try {
    folder.Write({{"a.txt", "content"}});
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), HasSubstr("No space left"));
  }
}

}  // namespace
}  // namespace vpslam
