#include "frontend/line_joiner.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace vpslam {
namespace {

using Verdict = LineJoiner::Verdict;

LineSet Lines(int64_t seq, size_t lines = 1) {
  LineSet set;
  set.frame_seq = seq;
  set.stamp_us = 1000 * seq;
  set.lines.resize(lines);
  return set;
}

LineJoinerOptions Realtime() {
  LineJoinerOptions options;
  options.wait_for_all = false;
  options.deadline_ms = 20;
  return options;
}

TEST(LineJoiner, AlienLinesMakeRoomForTheImagesOwn) {
  LineJoiner joiner({});
  LineSet alien = Lines(5, 3);
  alien.stamp_us = 77;
  EXPECT_FALSE(joiner.DropAlien(5, 5000));
  joiner.Add(alien);
  EXPECT_EQ(joiner.Look(5, 5000, 0, 0), Verdict::kWait);
  EXPECT_TRUE(joiner.DropAlien(5, 5000));
  EXPECT_TRUE(joiner.Add(Lines(5, 8)));
  EXPECT_FALSE(joiner.DropAlien(5, 5000));
  EXPECT_EQ(joiner.Take(5, 5000)->lines.size(), 8u);
}

TEST(LineJoiner, JoinsInWhateverOrderLinesCome) {
  LineJoiner joiner({});
  EXPECT_TRUE(joiner.Add(Lines(2, 12)));
  EXPECT_TRUE(joiner.Add(Lines(0, 10)));
  EXPECT_TRUE(joiner.Add(Lines(1, 11)));
  for (int64_t seq = 0; seq < 3; ++seq) {
    ASSERT_EQ(joiner.Look(seq, 1000 * seq, 0, 0), Verdict::kHere) << seq;
    const auto lines = joiner.Take(seq, 1000 * seq);
    ASSERT_TRUE(lines);
    EXPECT_EQ(lines->frame_seq, seq);
    EXPECT_EQ(lines->lines.size(), static_cast<size_t>(10 + seq));
  }
}

TEST(LineJoiner, TheFirstOfSeveralAnswersCounts) {
  LineJoiner joiner({});
  EXPECT_TRUE(joiner.Add(Lines(5, 1)));
  EXPECT_FALSE(joiner.Add(Lines(5, 2)));
  EXPECT_EQ(joiner.Take(5, 5000)->lines.size(), 1u);
  EXPECT_FALSE(joiner.Add(Lines(5, 3))) << "passed";
  EXPECT_FALSE(joiner.Add(Lines(4))) << "before one that was passed";
  EXPECT_FALSE(joiner.Take(5, 5000));
}

TEST(LineJoiner, WaitsHoweverLongWhereNothingMayBeLost) {
  LineJoiner joiner({});
  EXPECT_EQ(joiner.Look(0, 0, 0, int64_t{3600} * 1'000'000), Verdict::kWait);
}

TEST(LineJoiner, GoesOnAtTheDeadline) {
  LineJoiner joiner(Realtime());
  EXPECT_EQ(joiner.Look(7, 7000, 500, 500 + 19'000), Verdict::kWait);
  EXPECT_EQ(joiner.Look(7, 7000, 500, 500 + 20'000), Verdict::kGoOn);
  EXPECT_FALSE(joiner.Take(7, 7000));
  EXPECT_FALSE(joiner.Add(Lines(7))) << "too late";
  EXPECT_TRUE(joiner.Add(Lines(8)));
  EXPECT_EQ(joiner.Look(8, 8000, 0, 1'000'000), Verdict::kHere) << "late, but they are there";
}

TEST(LineJoiner, LinesOfAnotherSequenceAreNotTheImagesOwn) {
  LineJoiner joiner({});
  joiner.Add(Lines(3));
  EXPECT_EQ(joiner.Look(3, 77, 0, 0), Verdict::kWait);
  EXPECT_FALSE(joiner.Take(3, 77));
}

TEST(LineJoiner, AnImageThatIsLeftOutLeavesNothingBehind) {
  LineJoiner joiner(Realtime());
  joiner.Add(Lines(1));
  joiner.Add(Lines(2));
  EXPECT_TRUE(joiner.Take(2, 2000));
  EXPECT_FALSE(joiner.Take(1, 1000));
}

TEST(LineJoiner, KeepsNoMoreThanItMay) {
  LineJoinerOptions options;
  options.max_kept = 4;
  LineJoiner joiner(options);
  for (int64_t seq = 0; seq < 10; ++seq) joiner.Add(Lines(seq));
  EXPECT_EQ(joiner.Look(5, 5000, 0, 0), Verdict::kWait);
  EXPECT_EQ(joiner.Look(6, 6000, 0, 0), Verdict::kHere);
}

TEST(LineJoiner, ARestartBeginsAnew) {
  LineJoiner joiner({});
  joiner.Add(Lines(9));
  joiner.Take(9, 9000);
  joiner.Restart();
  EXPECT_TRUE(joiner.Add(Lines(0)));
  EXPECT_TRUE(joiner.Take(0, 0));
}

TEST(LineJoiner, RefusesOptionsWithoutSense) {
  LineJoinerOptions options;
  options.deadline_ms = -1;
  EXPECT_THROW(LineJoiner{options}, std::invalid_argument);
}

}  // namespace
}  // namespace vpslam
