#include "player/text_lines.h"

#include <gtest/gtest.h>

namespace vpslam {
namespace {

TEST(TextLines, CutsWordsAtBlanksAndCommas) {
  std::string_view line = "  12,a.png\t x y\r";
  EXPECT_EQ(TakeWord(&line), "12");
  EXPECT_EQ(TakeWord(&line), "a.png");
  EXPECT_EQ(Trim(line), "x y");
  EXPECT_EQ(TakeWord(&line), "x");
  EXPECT_EQ(TakeWord(&line), "y");
  EXPECT_EQ(TakeWord(&line), "");
  EXPECT_EQ(Trim(" \t\r"), "");
}

TEST(TextLines, TakesNumbers) {
  std::string_view line = "1, -2.5e1 +3 rest";
  const auto numbers = TakeNumbers<3>(&line);
  ASSERT_TRUE(numbers);
  EXPECT_EQ((*numbers)[1], -25);
  EXPECT_EQ((*numbers)[2], 3);
  EXPECT_EQ(Trim(line), "rest");
  for (std::string_view bad : {"1 2", "1 2 x", "1 nan 2", "1 2 inf"}) {
    EXPECT_FALSE(TakeNumbers<3>(&bad)) << bad;
  }
}

TEST(ParseStamp, ReadsDecimalSeconds) {
  EXPECT_EQ(ParseStamp_us("0"), 0);
  EXPECT_EQ(ParseStamp_us("0.000000"), 0);
  EXPECT_EQ(ParseStamp_us("1.036224e-01"), 103622);
  EXPECT_EQ(ParseStamp_us("1305031229.528748"), 1305031229528748);
  EXPECT_EQ(ParseStamp_us("1.7000020000333e9"), 1700002000033300);
  EXPECT_EQ(ParseStamp_us("-0.5"), -500000);
  for (const char* bad : {"", "a", "1.0s", "nan", "inf", "1e300"}) {
    EXPECT_EQ(ParseStamp_us(bad), std::nullopt) << bad;
  }
}

TEST(ParseStamp, ReadsNanoseconds) {
  EXPECT_EQ(ParseNanoseconds_us("0"), 0);
  EXPECT_EQ(ParseNanoseconds_us("1403636579763555584"), 1403636579763556);
  EXPECT_EQ(ParseNanoseconds_us("1403636579763555499"), 1403636579763555);
  for (const char* bad : {"", "a", "1.5", "-1", "99999999999999999999"}) {
    EXPECT_EQ(ParseNanoseconds_us(bad), std::nullopt) << bad;
  }
}

}  // namespace
}  // namespace vpslam
