#include "frontend/preview_publisher.h"

#include <thread>

#include <gtest/gtest.h>

#include "core/messages/command.h"
#include "core/transport/channels.h"
#include "core/transport/inbox.h"

namespace vpslam {
namespace {

using namespace std::chrono_literals;

class PreviewPublisherTest : public ::testing::Test {
 protected:
  PreviewPublisherTest() {
    BusOptions options;
    options.url = "memq://";
    bus_ = std::make_unique<Bus>(options);
    inbox_ = std::make_unique<Inbox<Preview>>(*bus_, kPreviewChannel, Inbox<Preview>::kUnbounded);
    camera_.width = 64;
    camera_.height = 48;
    camera_.fx = camera_.fy = 50;
    camera_.cx = 32;
    camera_.cy = 24;
  }

  /// Offers a frame every 10 ms; how often the scene was wanted.
  int OfferFrames(PreviewPublisher& publisher, int frames) {
    int wanted = 0;
    for (int i = 0; i < frames; ++i) {
      publisher.Offer([&] {
        ++wanted;
        PreviewScene scene;
        scene.frame_seq = i;
        return scene;
      });
      std::this_thread::sleep_for(10ms);
    }
    return wanted;
  }

  std::unique_ptr<Bus> bus_;
  std::unique_ptr<Inbox<Preview>> inbox_;
  Camera camera_;
};

TEST_F(PreviewPublisherTest, CostsNothingUnlessAskedFor) {
  PreviewPublisher publisher(*bus_, camera_, false);
  EXPECT_EQ(OfferFrames(publisher, 20), 0);
  EXPECT_FALSE(inbox_->HasMessage());
  Publisher<Command> commands(*bus_, kCommandChannel);
  commands.Publish({"backend", CommandAction::kShow});
  commands.Publish({"frontend", CommandAction::kStop});
  EXPECT_EQ(OfferFrames(publisher, 10), 0);
  commands.Publish({"frontend", CommandAction::kShow});
  ASSERT_TRUE(bus_->WaitFor(
      [&] {
        OfferFrames(publisher, 1);
        return inbox_->HasMessage();
      },
      20s));
  EXPECT_GT(inbox_->TryTake()->value.jpeg.size(), 100u);
}

TEST_F(PreviewPublisherTest, IsLimitedInRate) {
  PreviewPublisher publisher(*bus_, camera_, true);
  const auto start = PreviewPublisher::Clock::now();
  const int wanted = OfferFrames(publisher, 100);
  const auto periods = (PreviewPublisher::Clock::now() - start) / PreviewPublisher::kPeriod;
  EXPECT_GE(wanted, 1);
  EXPECT_LE(wanted, periods + 1);
}

}  // namespace
}  // namespace vpslam
