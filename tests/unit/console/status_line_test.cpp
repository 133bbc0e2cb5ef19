#include "console/status_line.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace vpslam {
namespace {

TEST(StatusLine, IsOneLineOfJson) {
  ProcessStatus status;
  status.process = "frontend";
  status.pid = 42;
  status.state = ProcessState::kFailed;
  status.rate_hz = 29.5;
  status.dropped = 3;
  status.message = "a \"quoted\"\nword \xff";
  const std::string line = StatusLine((1LL << 60) + 1, status);
  EXPECT_EQ(line.find('\n'), std::string::npos);
  const auto json = nlohmann::json::parse(line);
  EXPECT_EQ(json["process"], "frontend");
  EXPECT_EQ(json["session"], "1152921504606846977");
  EXPECT_EQ(json["pid"], 42);
  EXPECT_EQ(json["state"], "failed");
  EXPECT_EQ(json["rate_hz"], 29.5);
  EXPECT_EQ(json["dropped"], 3);
}

}  // namespace
}  // namespace vpslam
