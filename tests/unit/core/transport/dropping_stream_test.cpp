// Streams whose writer never waits: what is too old is given up, and the end still arrives.
#include <gtest/gtest.h>

#include "stream_harness.h"

namespace vpslam::test {
namespace {

BusOptions Memory(double drop_share = 0, uint64_t seed = 1) {
  BusOptions options;
  options.url = "memq://";
  options.drop_share = drop_share;
  options.drop_seed = seed;
  return options;
}

StreamWriterOptions Dropping(int window) {
  StreamWriterOptions options = QuickResend(window);
  options.drop_oldest = true;
  return options;
}

std::vector<int64_t> TakeAll(StreamReader<Preview>& reader) {
  std::vector<int64_t> numbers;
  while (const auto item = reader.TryTake()) {
    numbers.push_back(item->value.frame_seq);
    reader.Done(item->header);
  }
  return numbers;
}

TEST(DroppingStream, NeverWaitsForAConsumerThatIsNotDone) {
  Bus bus(Memory());
  StreamReader<Preview> reader(bus, kTestStream, "a", AckPolicy::kWhenDone);
  StreamWriter<Preview> writer(bus, kTestStream, {"a", "dead"}, Dropping(1));
  for (int i = 0; i < 50; ++i) {
    EXPECT_TRUE(writer.HasRoom());
    ASSERT_TRUE(writer.Send(Numbered(i)));
  }
  ASSERT_TRUE(bus.WaitFor([&] { return reader.size() == 50; }, 2s));
  EXPECT_EQ(TakeAll(reader), Count(0, 50)) << "what was given up was received before";
}

TEST(DroppingStream, ABoundedQueueKeepsTheNewestAndCountsTheOthers) {
  Bus bus(Memory());
  StreamReader<Preview> reader(bus, kTestStream, "a", AckPolicy::kWhenDone, 3);
  StreamWriter<Preview> writer(bus, kTestStream, {"a"}, Dropping(1));
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(writer.Send(Numbered(i)));
  ASSERT_TRUE(bus.WaitFor([&] { return bus.counters().dropped == 17; }, 2s));
  EXPECT_EQ(TakeAll(reader), Count(17, 20));
  ASSERT_TRUE(writer.Send(Numbered(20)));
  ASSERT_TRUE(bus.WaitFor([&] { return reader.HasMessage(); }, 2s));
  EXPECT_EQ(TakeAll(reader), Count(20, 21));
  EXPECT_EQ(bus.counters().dropped, 17);
  EXPECT_EQ(bus.counters().gaps, 0);
  EXPECT_TRUE(writer.WaitAllAcked(2s));
}

TEST(DroppingStream, TheEndArrivesInSpiteOfLosses) {
  for (const uint64_t seed : {1, 2, 3, 4, 5}) {
    Bus bus(Memory(0.4, seed));
    Consumer a(bus, "a", AckPolicy::kWhenDone);
    StreamWriter<Preview> writer(bus, kTestStream, {"a"}, Dropping(1));
    constexpr int kMessages = 40;
    for (int i = 0; i < kMessages; ++i) ASSERT_TRUE(writer.Send(Numbered(i)));
    ASSERT_TRUE(writer.SendEnd());
    EXPECT_TRUE(writer.WaitAllAcked(10s));
    a.Join();
    EXPECT_TRUE(a.ended());
    EXPECT_TRUE(std::is_sorted(a.numbers().begin(), a.numbers().end()));
    EXPECT_GT(a.numbers().size(), 10u);
    EXPECT_LT(a.numbers().size(), static_cast<std::size_t>(kMessages));
    ASSERT_FALSE(a.numbers().empty());
    EXPECT_EQ(a.numbers().front() + static_cast<int64_t>(a.numbers().size()) + bus.counters().gaps,
              kMessages)
        << "every message that did not come since the first one that did is counted";
  }
}

TEST(DroppingStream, AConsumerThatWasAwayGoesOnWithTheNewest) {
  Bus bus(Memory());
  StreamWriter<Preview> writer(bus, kTestStream, {"a"}, Dropping(2));
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(writer.Send(Numbered(i)));
  Consumer late(bus, "a", AckPolicy::kWhenDone);
  ASSERT_TRUE(writer.Send(Numbered(10)));
  ASSERT_TRUE(writer.SendEnd());
  EXPECT_TRUE(writer.WaitAllAcked(5s));
  late.Join();
  EXPECT_TRUE(late.ended());
  EXPECT_EQ(late.numbers().back(), 10);
  EXPECT_GE(late.numbers().front(), 9);
}

TEST(DroppingStream, ThatTheWriterWasRestartedIsToldEvenIfItsFirstMessagesWereDropped) {
  Bus bus(Memory());
  StreamReader<Preview> reader(bus, kTestStream, "a", AckPolicy::kWhenDone, 2);
  StreamWriterOptions first = Dropping(1), second = Dropping(1);
  first.session = 101;
  second.session = 102;
  StreamWriter<Preview> old_writer(bus, kTestStream, {"a"}, first);
  ASSERT_TRUE(old_writer.Send(Numbered(0)));
  ASSERT_TRUE(bus.WaitFor([&] { return reader.HasMessage(); }, 2s));
  TakeAll(reader);
  StreamWriter<Preview> new_writer(bus, kTestStream, {"a"}, second);
  for (int i = 100; i < 110; ++i) ASSERT_TRUE(new_writer.Send(Numbered(i)));
  ASSERT_TRUE(bus.WaitFor([&] { return bus.counters().dropped == 8; }, 2s));
  const auto item = reader.TryTake();
  ASSERT_TRUE(item);
  EXPECT_EQ(item->value.frame_seq, 108);
  EXPECT_TRUE(item->restarted);
  EXPECT_FALSE(reader.TryTake()->restarted);
}

}  // namespace
}  // namespace vpslam::test
