#include "player/time_order.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vpslam {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr int64_t kStep_us = 33'333;

std::vector<int64_t> Even(int n) {
  std::vector<int64_t> stamps;
  for (int i = 0; i < n; ++i) stamps.push_back(1'000'000 + kStep_us * i);
  return stamps;
}

std::vector<size_t> Numbers(size_t n) {
  std::vector<size_t> numbers(n);
  std::iota(numbers.begin(), numbers.end(), 0);
  return numbers;
}

void ExpectAscending(const TimeOrder& time) {
  for (size_t i = 1; i < time.stamps_us.size(); ++i) {
    EXPECT_LT(time.stamps_us[i - 1], time.stamps_us[i]) << i;
  }
}

TEST(TimeOrder, LeavesWhatIsInOrder) {
  const auto stamps = Even(50);
  const TimeOrder time = OrderByTime(stamps);
  EXPECT_EQ(time.order, Numbers(50));
  EXPECT_EQ(time.stamps_us, stamps);
  EXPECT_FALSE(time.sorted);
  EXPECT_THAT(OrderByTime({}).order, IsEmpty());
  EXPECT_THAT(OrderByTime(std::vector<int64_t>{7}).order, ElementsAre(0));
}

TEST(TimeOrder, SortsWhateverTheMixture) {
  const auto even = Even(60);
  std::mt19937 random(5);
  for (int trial = 0; trial < 40; ++trial) {
    auto stamps = even;
    if (trial == 0) std::reverse(stamps.begin(), stamps.end());
    if (trial == 1) std::rotate(stamps.begin(), stamps.begin() + 25, stamps.end());
    if (trial == 2) {  // by name: 1, 10, 11, ...
      std::vector<int> order(60);
      std::iota(order.begin(), order.end(), 0);
      std::sort(order.begin(), order.end(),
                [](int a, int b) { return std::to_string(a) < std::to_string(b); });
      for (int i = 0; i < 60; ++i) stamps[i] = even[order[i]];
    }
    if (trial == 3) {  // every second one first
      for (int i = 0; i < 60; ++i) stamps[i] = even[i < 30 ? 2 * i + 1 : 2 * (i - 30)];
    }
    if (trial > 3) std::shuffle(stamps.begin(), stamps.end(), random);
    const TimeOrder time = OrderByTime(stamps);
    EXPECT_EQ(time.stamps_us, even) << trial;
    EXPECT_TRUE(time.sorted);
    EXPECT_EQ(time.jump_us, 0);
  }
}

TEST(TimeOrder, PutsSingleLinesWhereTheyBelong) {
  using Move = std::pair<int, int>;
  for (const auto& [from, to] : std::vector<Move>{{20, 21}, {0, 40}, {59, 0}, {10, 59}}) {
    auto stamps = Even(60);
    const int64_t moved = stamps[from];
    stamps.erase(stamps.begin() + from);
    stamps.insert(stamps.begin() + to, moved);
    const TimeOrder time = OrderByTime(stamps);
    EXPECT_EQ(time.stamps_us, Even(60)) << from << " to " << to;
    EXPECT_THAT(time.set_aside, IsEmpty());
  }
}

TEST(TimeOrder, SetsAsideStampsThatFitNowhere) {
  for (const int64_t off_us :
       std::vector<int64_t>{1'000'000'000'000'000, 700'000, 3'000'000, -700'000, -9'000'000}) {
    auto stamps = Even(60);
    stamps[30] += off_us;
    const TimeOrder time = OrderByTime(stamps);
    EXPECT_THAT(time.set_aside, ElementsAre(30)) << off_us;
    EXPECT_EQ(time.order.size(), 59u);
    ExpectAscending(time);
  }
}

TEST(TimeOrder, BridgesAClockThatIsSetBack) {
  for (const int64_t back_us :
       std::vector<int64_t>{300'000, 1'000'000, 5'000'000, 1'785'000'000'000'000}) {
    for (const int at : {10, 30, 50}) {
      auto stamps = Even(60);
      for (int i = at; i < 60; ++i) stamps[i] -= back_us;
      const TimeOrder time = OrderByTime(stamps);
      EXPECT_EQ(time.order, Numbers(60)) << back_us << " at " << at;
      EXPECT_EQ(time.jump_at, at);
      EXPECT_NEAR(static_cast<double>(time.jump_us - back_us), 0, 2);
      ExpectAscending(time);
    }
  }
}

TEST(TimeOrder, CountsClocksThatAreNotOne) {
  auto stamps = Even(90);
  for (int i = 30; i < 90; ++i) stamps[i] -= 500'017;
  for (int i = 60; i < 90; ++i) stamps[i] -= 500'017;
  EXPECT_EQ(OrderByTime(stamps).clocks, 3);
}

TEST(TimeOrder, KeepsTheFirstOfRepeatedStamps) {
  std::vector<int64_t> stamps;
  for (int i = 0; i < 40; ++i) stamps.push_back(kStep_us * (i - i % 2));
  const TimeOrder time = OrderByTime(stamps);
  EXPECT_EQ(time.order.size(), 20u);
  EXPECT_EQ(time.repeated.size(), 20u);
  EXPECT_EQ(time.repeated[0], 1u);
  ExpectAscending(time);
}

TEST(TimeOrder, LeavesGapsAsTheyAre) {
  auto stamps = Even(40);
  for (int i = 10; i < 40; ++i) stamps[i] += 1'785'000'000'000'000;
  const TimeOrder time = OrderByTime(stamps);
  EXPECT_EQ(time.stamps_us, stamps);
  EXPECT_FALSE(time.sorted);
}

TEST(TimeOrder, IsAscendingForWhateverComes) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 500; ++trial) {
    std::vector<int64_t> stamps(1 + random() % 50);
    for (int64_t& stamp : stamps) stamp = static_cast<int64_t>(random() % 60);
    const TimeOrder time = OrderByTime(stamps);
    if (time.clocks > 1) continue;
    ExpectAscending(time);
    EXPECT_EQ(time.order.size() + time.repeated.size() + time.set_aside.size(), stamps.size());
  }
}

}  // namespace
}  // namespace vpslam
