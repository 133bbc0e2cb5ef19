#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/transport/ack.h"
#include "core/transport/channels.h"
#include "core/transport/inbox.h"
#include "core/transport/publisher.h"
#include "stream_harness.h"

namespace vpslam::test {
namespace {

using ::testing::ElementsAre;

BusOptions Memory(double drop_share = 0, uint64_t seed = 1) {
  BusOptions options;
  options.url = "memq://";
  options.drop_share = drop_share;
  options.drop_seed = seed;
  return options;
}

TEST(Stream, DeliversInOrderWithItsEnd) {
  Bus bus(Memory());
  Consumer a(bus, "a", AckPolicy::kOnReceipt), b(bus, "b", AckPolicy::kWhenDone);
  StreamWriter<Preview> writer(bus, kTestStream, {"a", "b"});
  for (int i = 0; i < 200; ++i) ASSERT_TRUE(writer.Send(Numbered(i)));
  ASSERT_TRUE(writer.SendEnd());
  EXPECT_TRUE(writer.WaitAllAcked(5s));
  EXPECT_EQ(writer.acked(), 200);
  a.Join();
  b.Join();
  EXPECT_EQ(a.numbers(), Count(0, 200));
  EXPECT_EQ(b.numbers(), Count(0, 200));
  EXPECT_TRUE(a.ended() && b.ended());
}

class LossyStream : public ::testing::TestWithParam<std::tuple<int, AckPolicy>> {};

TEST_P(LossyStream, NothingIsMissingOrDoubledUnderLoss) {
  const auto [window, policy] = GetParam();
  Bus bus(Memory(0.2, 7 + window));
  Consumer a(bus, "a", policy), b(bus, "b", policy);
  StreamWriter<Preview> writer(bus, kTestStream, {"a", "b"}, QuickResend(window));
  constexpr int kMessages = 40;
  for (int i = 0; i < kMessages; ++i) ASSERT_TRUE(writer.Send(Numbered(i)));
  ASSERT_TRUE(writer.SendEnd());
  EXPECT_TRUE(writer.WaitAllAcked(20s));
  a.Join();
  b.Join();
  EXPECT_EQ(a.numbers(), Count(0, kMessages));
  EXPECT_EQ(b.numbers(), Count(0, kMessages));
  EXPECT_GT(bus.counters().lost_on_purpose, 0);
  EXPECT_GT(bus.counters().resent, 0);
}
INSTANTIATE_TEST_SUITE_P(Windows, LossyStream,
                         ::testing::Combine(::testing::Values(1, 4, 64),
                                            ::testing::Values(AckPolicy::kOnReceipt,
                                                              AckPolicy::kWhenDone)));

TEST(Stream, SendWaitsForTheWindowAndDone) {
  Bus bus(Memory());
  StreamReader<Preview> reader(bus, kTestStream, "a", AckPolicy::kWhenDone);
  StreamWriter<Preview> writer(bus, kTestStream, {"a"}, QuickResend(2));
  ASSERT_TRUE(writer.Send(Numbered(0)));
  ASSERT_TRUE(writer.Send(Numbered(1)));
  std::atomic<bool> sent{false};
  std::thread sender([&] {
    writer.Send(Numbered(2));
    sent = true;
  });
  ASSERT_TRUE(bus.WaitFor([&] { return reader.size() == 2; }, 2s));
  std::this_thread::sleep_for(100ms);
  EXPECT_FALSE(sent) << "two messages are under work, the window is two";
  EXPECT_EQ(writer.acked(), -1);
  reader.Done(reader.TryTake()->header);
  sender.join();
  EXPECT_TRUE(sent);
  EXPECT_EQ(writer.acked(), 0);
}

TEST(Stream, AnInterruptEndsABlockedSend) {
  Bus bus(Memory());
  StreamWriter<Preview> writer(bus, kTestStream, {"nobody"}, QuickResend(1));
  ASSERT_TRUE(writer.Send(Numbered(0)));
  std::thread stopper([&] {
    std::this_thread::sleep_for(50ms);
    bus.Interrupt();
  });
  EXPECT_FALSE(writer.Send(Numbered(1)));
  EXPECT_FALSE(writer.WaitAllAcked(10s));
  stopper.join();
}

TEST(Stream, AConsumerThatNeverAnswersIsNamed) {
  Bus bus(Memory());
  Consumer alive(bus, "alive", AckPolicy::kWhenDone);
  StreamWriterOptions options = QuickResend(1);
  options.peer_timeout = 300ms;
  StreamWriter<Preview> writer(bus, kTestStream, {"alive", "dead"}, options);
  ASSERT_TRUE(writer.Send(Numbered(0)));
  try {
    writer.Send(Numbered(1));
    FAIL() << "waited for a dead consumer without an error";
  } catch (const PeerGoneError& e) {
    EXPECT_NE(std::string(e.what()).find("dead"), std::string::npos) << e.what();
  }
  bus.Interrupt();
}

TEST(Stream, ASlowConsumerIsNotADeadOne) {
  Bus bus(Memory());
  Consumer slow(bus, "slow", AckPolicy::kWhenDone, 700ms);
  StreamWriterOptions options = QuickResend(1);
  options.peer_timeout = 300ms;
  StreamWriter<Preview> writer(bus, kTestStream, {"slow"}, options);
  ASSERT_TRUE(writer.Send(Numbered(0)));
  EXPECT_TRUE(writer.Send(Numbered(1)));
  EXPECT_TRUE(writer.SendEnd());
  EXPECT_TRUE(writer.WaitAllAcked(5s));
}

TEST(Stream, WithoutConsumersNothingIsWaitedFor) {
  Bus bus(Memory());
  Inbox<Preview> inbox(bus, kTestStream, 100);
  StreamWriter<Preview> writer(bus, kTestStream, {}, QuickResend(1));
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(writer.Send(Numbered(i)));
  EXPECT_TRUE(writer.WaitAllAcked(0ms));
  EXPECT_TRUE(bus.WaitFor([&] { return inbox.size() == 20; }, 2s));
}

TEST(Stream, ALateConsumerGetsWhatIsStillKept) {
  Bus bus(Memory());
  Consumer early(bus, "early", AckPolicy::kOnReceipt);
  StreamWriter<Preview> writer(bus, kTestStream, {"early", "late"}, QuickResend(4));
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(writer.Send(Numbered(i)));
  std::this_thread::sleep_for(50ms);
  Consumer late(bus, "late", AckPolicy::kOnReceipt);
  for (int i = 4; i < 10; ++i) ASSERT_TRUE(writer.Send(Numbered(i)));
  ASSERT_TRUE(writer.SendEnd());
  EXPECT_TRUE(writer.WaitAllAcked(5s));
  early.Join();
  late.Join();
  EXPECT_EQ(early.numbers(), Count(0, 10));
  EXPECT_EQ(late.numbers(), Count(0, 10));
}

TEST(Stream, AListenerThatNobodyWaitsForGoesOnAfterALoss) {
  Bus bus(Memory(0.3, 3));
  Consumer needed(bus, "needed", AckPolicy::kOnReceipt);
  StreamReader<Preview> listener(bus, kTestStream, "listener", AckPolicy::kOnReceipt);
  StreamWriter<Preview> writer(bus, kTestStream, {"needed"}, QuickResend(1));
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(writer.Send(Numbered(i)));
  ASSERT_TRUE(writer.SendEnd());
  EXPECT_TRUE(writer.WaitAllAcked(20s));
  std::vector<int64_t> heard;
  while (const auto item = listener.TryTake()) heard.push_back(item->value.frame_seq);
  EXPECT_GT(heard.size(), 15u);
  EXPECT_LT(heard.size(), 30u);
  EXPECT_TRUE(std::is_sorted(heard.begin(), heard.end()));
}

TEST(Stream, ARestartedWriterIsFollowedAndTheOldOneForgotten) {
  Bus bus(Memory());
  StreamReader<Preview> reader(bus, kTestStream, "a", AckPolicy::kOnReceipt);
  const auto take = [&] {
    EXPECT_TRUE(bus.WaitFor([&] { return reader.HasMessage(); }, 2s));
    return *reader.TryTake();
  };
  StreamWriterOptions first = QuickResend(4), second = QuickResend(4);
  first.session = 101;
  second.session = 102;
  StreamWriter<Preview> old_writer(bus, kTestStream, {"a"}, first);
  for (int i = 0; i < 3; ++i) {
    old_writer.Send(Numbered(i));
    EXPECT_FALSE(take().restarted);
  }
  StreamWriter<Preview> new_writer(bus, kTestStream, {"a"}, second);
  new_writer.Send(Numbered(100));
  auto item = take();
  EXPECT_TRUE(item.restarted);
  EXPECT_EQ(item.value.frame_seq, 100);
  EXPECT_EQ(item.header.session, 102);
  old_writer.Send(Numbered(3));  // a ghost
  new_writer.Send(Numbered(101));
  item = take();
  EXPECT_FALSE(item.restarted);
  EXPECT_EQ(item.value.frame_seq, 101);
  EXPECT_TRUE(new_writer.WaitAllAcked(2s));
}

TEST(Stream, ARestartedReaderTakesUpWhereTheOldOneStopped) {
  Bus bus(Memory());
  StreamWriter<Preview> writer(bus, kTestStream, {"a"}, QuickResend(2));
  {
    StreamReader<Preview> reader(bus, kTestStream, "a", AckPolicy::kWhenDone);
    for (int i = 0; i < 2; ++i) writer.Send(Numbered(i));
    ASSERT_TRUE(bus.WaitFor([&] { return reader.size() == 2; }, 2s));
    reader.Done(reader.TryTake()->header);
  }  // dies with message 1 taken but not done
  Consumer again(bus, "a", AckPolicy::kWhenDone);
  for (int i = 2; i < 5; ++i) ASSERT_TRUE(writer.Send(Numbered(i)));
  ASSERT_TRUE(writer.SendEnd());
  EXPECT_TRUE(writer.WaitAllAcked(5s));
  again.Join();
  EXPECT_EQ(again.numbers(), Count(1, 5));
}

TEST(Stream, AlienAcknowledgementsChangeNothing) {
  Bus bus(Memory());
  StreamWriter<Preview> writer(bus, kTestStream, {"a"}, QuickResend(1));
  ASSERT_TRUE(writer.Send(Numbered(0)));
  Publisher<Ack> acks(bus, kAckChannel);
  acks.Publish({"OTHER", bus.session(), "a", 0, 0});
  acks.Publish({kTestStream, bus.session() + 1, "a", 0, 0});
  acks.Publish({kTestStream, bus.session(), "b", 0, 0});
  acks.Publish({kTestStream, bus.session(), "a", 1, 1});  // was never sent
  EXPECT_FALSE(writer.WaitAllAcked(150ms));
  acks.Publish({kTestStream, bus.session(), "a", 0, 0});
  EXPECT_TRUE(writer.WaitAllAcked(2s));
}

TEST(Stream, RefusedMessagesAreCountedAndDoNotDisturb) {
  Bus bus(Memory());
  Consumer a(bus, "a", AckPolicy::kOnReceipt);
  StreamWriter<Preview> writer(bus, kTestStream, {"a"}, QuickResend(1));
  const std::vector<uint8_t> noise(100, 0x5a);
  for (int i = 0; i < 10; ++i) {
    bus.Publish(kTestStream, noise);
    bus.Publish(kAckChannel, noise);
    ASSERT_TRUE(writer.Send(Numbered(i)));
  }
  ASSERT_TRUE(writer.SendEnd());
  EXPECT_TRUE(writer.WaitAllAcked(5s));
  a.Join();
  EXPECT_EQ(a.numbers(), Count(0, 10));
  EXPECT_EQ(bus.counters().rejected, 20);
}

TEST(Stream, AValueThatMayNotBeSentLeavesTheStreamIntact) {
  Bus bus(Memory());
  Consumer a(bus, "a", AckPolicy::kOnReceipt);
  StreamWriter<Preview> writer(bus, kTestStream, {"a"});
  ASSERT_TRUE(writer.Send(Numbered(0)));
  EXPECT_THROW(writer.Send(Preview()), std::invalid_argument);
  ASSERT_TRUE(writer.Send(Numbered(1)));
  ASSERT_TRUE(writer.SendEnd());
  EXPECT_TRUE(writer.WaitAllAcked(5s));
  a.Join();
  EXPECT_EQ(a.numbers(), Count(0, 2));
}

}  // namespace
}  // namespace vpslam::test
