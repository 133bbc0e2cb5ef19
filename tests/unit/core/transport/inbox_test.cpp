#include "core/transport/inbox.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/messages/preview.h"
#include "core/transport/publisher.h"
#include "stream_harness.h"

namespace vpslam::test {
namespace {

using ::testing::ElementsAre;

class InboxTest : public ::testing::Test {
 protected:
  static BusOptions Memory() {
    BusOptions options;
    options.url = "memq://";
    return options;
  }
  void Send(int64_t session, int64_t seq, bool last = false) {
    Header header;
    header.session = session;
    header.seq = seq;
    header.last = last;
    bus_.Publish(kTestStream, Encode(header, Numbered(seq)));
    ++sent_;
  }
  std::vector<int64_t> Take(Inbox<Preview>& inbox) {
    EXPECT_TRUE(bus_.WaitFor([&] { return bus_.counters().received == sent_; }, 2s));
    std::vector<int64_t> numbers;
    while (const auto message = inbox.TryTake()) numbers.push_back(message->value.frame_seq);
    return numbers;
  }

  Bus bus_{Memory()};
  int64_t sent_ = 0;
};

TEST_F(InboxTest, AFullQueueDropsTheOldestAndCounts) {
  Inbox<Preview> inbox(bus_, kTestStream, 2);
  for (int i = 0; i < 5; ++i) Send(1, i);
  EXPECT_THAT(Take(inbox), ElementsAre(3, 4));
  EXPECT_EQ(inbox.dropped(), 3);
  EXPECT_EQ(bus_.counters().dropped, 3);
}

TEST_F(InboxTest, UnboundedKeepsAll) {
  Inbox<Preview> inbox(bus_, kTestStream, Inbox<Preview>::kUnbounded);
  for (int i = 0; i < 100; ++i) Send(1, i);
  EXPECT_EQ(Take(inbox), Count(0, 100));
}

TEST_F(InboxTest, CountsGapsPerSender) {
  Inbox<Preview> inbox(bus_, kTestStream, 100);
  Send(1, 10);
  Send(2, 0);
  Send(1, 11);
  Send(1, 14);
  Send(2, 2);
  EXPECT_THAT(Take(inbox), ElementsAre(10, 0, 11, 14, 2));
  EXPECT_EQ(bus_.counters().gaps, 3);
}

TEST_F(InboxTest, RepeatedAndOvertakenMessagesAreLeftOut) {
  Inbox<Preview> inbox(bus_, kTestStream, 100);
  for (const int64_t seq : {0, 1, 1, 0, 2}) Send(1, seq);
  EXPECT_THAT(Take(inbox), ElementsAre(0, 1, 2));
}

TEST_F(InboxTest, ARestartedSenderBeginsAnew) {
  Inbox<Preview> inbox(bus_, kTestStream, 100);
  Send(1, 7);
  Send(2, 0);
  EXPECT_THAT(Take(inbox), ElementsAre(7, 0));
  EXPECT_EQ(bus_.counters().gaps, 0);
}

TEST_F(InboxTest, EndMarkersAreNoMessages) {
  Inbox<Preview> inbox(bus_, kTestStream, 100);
  Send(1, 0);
  Send(1, 1, true);
  EXPECT_THAT(Take(inbox), ElementsAre(0));
}

TEST_F(InboxTest, PublishersNumberTheirMessages) {
  Inbox<Preview> inbox(bus_, kTestStream, 100);
  Publisher<Preview> publisher(bus_, kTestStream);
  publisher.Publish(Numbered(5));
  EXPECT_THROW(publisher.Publish(Preview()), std::invalid_argument);
  publisher.Publish(Numbered(6));
  sent_ = 2;
  EXPECT_THAT(Take(inbox), ElementsAre(5, 6));
  EXPECT_EQ(bus_.counters().gaps, 0) << "what could not be sent takes no number";
}

TEST(SequenceWatch, ForgetsTheLongestSilentSender) {
  SequenceWatch watch;
  Header header;
  for (header.session = 1; header.session <= 64; ++header.session) {
    EXPECT_TRUE(watch.See(header).new_sender);
  }
  header.session = 1;
  header.seq = 1;
  EXPECT_FALSE(watch.See(header).new_sender);  // heard: session 2 is the oldest now
  header.session = 65;
  EXPECT_TRUE(watch.See(header).new_sender);
  header.session = 1;
  header.seq = 2;
  EXPECT_FALSE(watch.See(header).new_sender);
  header.session = 2;
  EXPECT_TRUE(watch.See(header).new_sender);
}

}  // namespace
}  // namespace vpslam::test
