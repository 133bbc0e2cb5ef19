#include "core/base/settings.h"

#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace vpslam {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

struct Options {
  int count = 3;
  struct Inner {
    double size = 0.5;
    template <class V>
    void Visit(V& v) {
      v("size", size);
    }
  } inner;

  template <class V>
  void Visit(V& v) {
    v("count", count);
    v("inner", inner);
  }
  std::optional<std::string> Validate() const {
    if (count < 0) return "count must not be negative";
    return std::nullopt;
  }
};

class Settings : public ::testing::Test {
 protected:
  ~Settings() override { std::filesystem::remove(path_); }

  Options Load(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
    std::ofstream(path_) << yaml;
    return LoadSettings<Options>(path_, "frontend", overrides);
  }
  std::string Error(const std::string& yaml, const std::vector<std::string>& overrides = {}) {
    try {
      Load(yaml, overrides);
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return {};
  }

  const std::string path_ =
      (std::filesystem::temp_directory_path() / fmt::format("vpslam_settings_{}.yaml", getpid()))
          .string();
};

TEST_F(Settings, ReadsItsSectionAndThenOverrides) {
  EXPECT_EQ(LoadSettings<Options>("", "frontend", {}).count, 3);
  const Options options = Load("frontend:\n  count: 5\n  inner:\n    size: 2\nbackend:\n  x: 1\n",
                               {"frontend.count=7", "backend.anything=1"});
  EXPECT_EQ(options.count, 7);
  EXPECT_EQ(options.inner.size, 2);
  EXPECT_THAT(PrintSettings(options), AllOf(HasSubstr("count=7"), HasSubstr("inner.size=2")));
}

TEST_F(Settings, RefusesUnknownSections) {
  EXPECT_THAT(Error("front_end:\n  count: 5\n"),
              AllOf(HasSubstr(path_), HasSubstr("front_end"), HasSubstr("there are frontend")));
  EXPECT_THAT(Error("count: 5\n"), AllOf(HasSubstr("count"), HasSubstr("no such section")));
}

TEST_F(Settings, RefusesUnknownKeysAndWrongValues) {
  EXPECT_THAT(Error("frontend:\n  cuont: 5\n"),
              AllOf(HasSubstr(path_), HasSubstr("frontend.cuont"), HasSubstr("count, inner")));
  EXPECT_THAT(Error("frontend:\n  inner:\n    sise: 5\n"), HasSubstr("frontend.inner.sise"));
  EXPECT_THAT(Error("frontend:\n  count: many\n"), HasSubstr("'many'"));
  EXPECT_THAT(Error("frontend: 5\n"), HasSubstr("section"));
  EXPECT_THAT(Error("frontend:\n  count: -1\n"), HasSubstr("negative"));
  EXPECT_THAT(Error("frontend: [\n"), AllOf(HasSubstr(path_), HasSubstr("not YAML")));
  EXPECT_THAT(Error("", {}), HasSubstr("sections"));
  EXPECT_THAT(Error("frontend: {}\n", {"frontend.count"}), HasSubstr("section.key=value"));
  std::filesystem::remove(path_);
  EXPECT_THROW(LoadSettings<Options>(path_, "frontend", {}), std::runtime_error);
}

}  // namespace
}  // namespace vpslam
