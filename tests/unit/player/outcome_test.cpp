#include "player/outcome.h"

#include <gtest/gtest.h>

namespace vpslam {
namespace {

TEST(Outcome, AllWasPlayed) {
  SourceReport report;
  report.expected = 60;
  const auto outcome = DescribeOutcome(report, 60, "stopped");
  EXPECT_EQ(OutcomeLine(outcome), "played 60 of 60 images");
  EXPECT_TRUE(outcome["skipped"].empty());
}

TEST(Outcome, WhatIsMissingHasAReason) {
  SourceReport report;
  report.expected = 60;
  report.skipped = {{"is missing", 2}, {"is truncated", 1}};
  report.notes = {"a line"};
  const auto outcome = DescribeOutcome(report, 40, "stopped");
  EXPECT_EQ(OutcomeLine(outcome),
            "played 40 of 60 images: 2 skipped (is missing), 1 skipped (is truncated), 17 skipped "
            "(stopped)");
  EXPECT_EQ(outcome["notes"][0], "a line");
}

TEST(Outcome, WhatIsNotKnownIsSaid) {
  SourceReport report;
  EXPECT_EQ(OutcomeLine(DescribeOutcome(report, 7, "stopped")), "played 7 of unknown images");
  report.expected = 7;
  report.without_end = "a.lcm is cut off";
  EXPECT_EQ(OutcomeLine(DescribeOutcome(report, 7, "stopped")),
            "played 7 of at least 7 images: the rest skipped (a.lcm is cut off)");
}

TEST(Outcome, ReadingAheadCountsNothingTwice) {
  SourceReport report;
  report.expected = 10;
  report.skipped = {{"is truncated", 2}};
  const auto outcome = DescribeOutcome(report, 9, "stopped");
  EXPECT_EQ(outcome["expected"], 11);
  EXPECT_EQ(outcome["skipped"].size(), 1u);
}

}  // namespace
}  // namespace vpslam
