// Streams over real multicast, with the receive buffer and the losses of a bad day. In a network
// namespace of its own where possible, and on a port of its own anyway.
#include <atomic>
#include <memory>
#include <span>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/transport/channels.h"
#include "core/transport/codec.h"
#include "core/transport/inbox.h"
#include "core/transport/peers.h"
#include "core/transport/publisher.h"
#include "core/transport/status_reporter.h"
#include "stream_harness.h"

namespace vpslam::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

BusOptions Udp(double drop_share = 0, uint64_t seed = 1) {
  BusOptions options;
  options.url = fmt::format("udpm://239.255.76.67:{}", 20000 + getpid() % 20000);
  options.drop_share = drop_share;
  options.drop_seed = seed;
  return options;
}

TEST(Udp, TheUrlKeepsTheGraphLocalAndItsBufferLarge) {
  Bus bus(Udp());
  EXPECT_THAT(bus.url(), HasSubstr("ttl=0"));
  EXPECT_THAT(bus.url(), HasSubstr("recv_buf_size=4194304"));
  BusOptions options = Udp();
  options.url += "?recv_buf_size=100000";
  EXPECT_THAT(Bus(options).url(), HasSubstr("?recv_buf_size=100000&ttl=0"));
}

TEST(Udp, PublishersReachOtherInstances) {
  Bus a(Udp()), b(Udp());
  Inbox<Preview> inbox(b, kTestStream, 10);
  Publisher<Preview> publisher(a, kTestStream);
  publisher.Publish(Numbered(1, 60000));
  EXPECT_TRUE(b.WaitFor([&] { return inbox.HasMessage(); }, 5s));
}

TEST(Udp, OneInstanceOfAProcessIsEnoughToGoOn) {
  Bus a(Udp()), b(Udp()), listener(Udp());
  Peers peers(listener);
  std::atomic<bool> heard_of_failure = false;
  const auto registration = listener.Subscribe(kStatusChannel, [&](std::span<const uint8_t> bytes) {
    std::string why;
    const auto status = Decode<ProcessStatus>(bytes, &why);
    if (status && status->value.state == ProcessState::kFailed) heard_of_failure = true;
  });
  StatusReporter one(a, "vpdetector");
  auto other = std::make_unique<StatusReporter>(b, "vpdetector");
  EXPECT_THAT(peers.NotReady({"vpdetector"}), ElementsAre("vpdetector"));
  one.SetState(ProcessState::kRunning);
  ASSERT_TRUE(peers.WaitReady({"vpdetector"}, 5s));
  other->SetState(ProcessState::kFailed, "out of paper");
  ASSERT_TRUE(listener.WaitFor([&] { return heard_of_failure.load(); }, 5s));
  EXPECT_FALSE(peers.WhyGone("vpdetector"));
  EXPECT_THAT(peers.NotReady({"vpdetector"}), IsEmpty());
  one.SetState(ProcessState::kFinished);
  ASSERT_TRUE(listener.WaitFor([&] { return peers.WhyGone("vpdetector").has_value(); }, 5s));
  EXPECT_THAT(peers.NotReady({"vpdetector"}), ElementsAre("vpdetector"));
}

struct Case {
  std::size_t size;
  int window;
  int messages;
};
class UdpStream : public ::testing::TestWithParam<Case> {};

TEST_P(UdpStream, EverythingArrivesInOrderThroughLossAndASmallBuffer) {
  const Case c = GetParam();
  const auto options = [](uint64_t seed) {
    BusOptions o = Udp(0.05, seed);
    o.receive_buffer = 212992 / 2;  // the kernel doubles it
    return o;
  };
  Bus writer_bus(options(1)), a_bus(options(2)), b_bus(options(3));
  Consumer a(a_bus, "a", AckPolicy::kWhenDone), b(b_bus, "b", AckPolicy::kOnReceipt);
  StreamWriterOptions stream = QuickResend(c.window);
  StreamWriter<Preview> writer(writer_bus, kTestStream, {"a", "b"}, stream);
  for (int i = 0; i < c.messages; ++i) ASSERT_TRUE(writer.Send(Numbered(i, c.size)));
  ASSERT_TRUE(writer.SendEnd());
  EXPECT_TRUE(writer.WaitAllAcked(30s));
  a.Join();
  b.Join();
  EXPECT_EQ(a.numbers(), Count(0, c.messages));
  EXPECT_EQ(b.numbers(), Count(0, c.messages));
  EXPECT_TRUE(a.contents_right() && b.contents_right());
  EXPECT_TRUE(a.ended() && b.ended());
  RecordProperty("resent", static_cast<int>(writer_bus.counters().resent));
}
INSTANTIATE_TEST_SUITE_P(Sizes, UdpStream,
                         ::testing::Values(Case{200, 1, 80}, Case{200, 64, 300}, Case{60000, 2, 80},
                                           Case{60000, 4, 80}));

}  // namespace
}  // namespace vpslam::test
