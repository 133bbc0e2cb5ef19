#include "player/play.h"

#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "core/messages/command.h"
#include "core/messages/truth.h"
#include "core/transport/camera_link.h"
#include "core/transport/channels.h"
#include "core/transport/image_pool.h"
#include "core/transport/inbox.h"
#include "core/transport/publisher.h"
#include "core/transport/stream_reader.h"

namespace vpslam {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// Grey images of 32 x 16 px, image i with value 50 + i and stamp 1 s + 0.1 s * i.
class PlainSource : public ImageSource {
 public:
  explicit PlainSource(int frames, int broken_at = -1) : frames_(frames), broken_at_(broken_at) {
    camera_.width = 32;
    camera_.height = 16;
    camera_.fx = camera_.fy = 30;
    camera_.cx = 15.5;
    camera_.cy = 7.5;
  }
  const Camera& camera() const override { return camera_; }
  std::optional<SourceFrame> Next() override {
    if (next_ == broken_at_) throw std::runtime_error("the source broke down");
    if (next_ == frames_) return std::nullopt;
    const int i = next_++;
    return SourceFrame{1'000'000 + i * 100'000, cv::Mat(16, 32, CV_8UC1, cv::Scalar(50 + i)), 1.5};
  }
  std::optional<SE3> WorldFromCam(int64_t stamp_us) const override {
    return SE3(Eigen::Quaterniond::Identity(), {1e-6 * static_cast<double>(stamp_us), 0, 0});
  }

 private:
  Camera camera_;
  int frames_, broken_at_, next_ = 0;
};

/// The player in a thread of its own, and a frontend that this test plays, on one in-process bus.
class PlayTest : public ::testing::Test {
 protected:
  PlayTest() {
    options_.required = {"frontend"};
    BusOptions bus_options;
    bus_options.url = "memq://";
    bus_ = std::make_unique<Bus>(bus_options);
    peers_ = std::make_unique<Peers>(*bus_);
    player_status_ = std::make_unique<StatusReporter>(*bus_, "player");
    frontend_status_ = std::make_unique<StatusReporter>(*bus_, "frontend");
    images_ = std::make_unique<StreamReader<ImageMessage>>(*bus_, kImageChannel, "frontend",
                                                           AckPolicy::kWhenDone);
  }
  ~PlayTest() override {
    if (player_.joinable()) player_.join();
  }

  void StartPlayer(int frames, int broken_at = -1) {
    player_ = std::thread([this, frames, broken_at] {
      PlainSource source(frames, broken_at);
      try {
        sent_ = Play(*bus_, *peers_, *player_status_, source, options_, stop_);
      } catch (const std::exception& e) {
        error_ = e.what();
      }
    });
  }
  /// Consumes images until the end, or fails after 20 s.
  void Consume(const std::function<void(const ImageFrame&)>& use) {
    frontend_status_->SetState(ProcessState::kReady);
    ImageFetcher fetcher;
    while (!images_->Ended()) {
      ASSERT_TRUE(bus_->WaitFor([this] { return images_->HasNews(); }, seconds(20)));
      auto item = images_->TryTake();
      if (!item) continue;
      std::string why;
      const auto frame = fetcher.Fetch(item->value, &why);
      ASSERT_TRUE(frame) << why;
      use(*frame);
      images_->Done(item->header);
    }
    player_.join();
  }

  PlayOptions options_;
  std::atomic<bool> stop_ = false;
  int64_t sent_ = -1;
  std::string error_;
  std::unique_ptr<Bus> bus_;
  std::unique_ptr<Peers> peers_;
  std::unique_ptr<StatusReporter> player_status_, frontend_status_;
  std::unique_ptr<StreamReader<ImageMessage>> images_;
  std::thread player_;
};

TEST_F(PlayTest, SendsEveryImageInLockstep) {
  CameraReceiver camera(*bus_);
  Inbox<Truth> truth(*bus_, kTruthChannel, Inbox<Truth>::kUnbounded);
  StartPlayer(6);
  int i = 0;
  Consume([&](const ImageFrame& frame) {
    EXPECT_EQ(frame.frame_seq, i);
    EXPECT_EQ(frame.stamp_us, 1'000'000 + i * 100'000);
    EXPECT_EQ(frame.decode_ms, 1.5);
    EXPECT_EQ(frame.pixels.size(), cv::Size(32, 16));
    EXPECT_EQ(frame.pixels.at<uint8_t>(15, 31), 50 + i);
    std::this_thread::sleep_for(milliseconds(5));
    EXPECT_FALSE(images_->HasMessage()) << "the next image came before this one was done with";
    ++i;
  });
  EXPECT_EQ(error_, "");
  EXPECT_EQ(i, 6);
  EXPECT_EQ(sent_, 6);
  EXPECT_EQ(player_status_->Snapshot().processed, 6);
  const auto received = camera.TryTake();
  ASSERT_TRUE(received);
  EXPECT_EQ(received->cx, 15.5);
  ASSERT_EQ(truth.size(), 6u);
  const Truth first = truth.TryTake()->value;
  EXPECT_EQ(first.frame_seq, 0);
  EXPECT_EQ(first.world_from_cam.translation.x(), 1);
}

TEST_F(PlayTest, SendsPixelsInline) {
  options_.inline_pixels = true;
  StartPlayer(3);
  int i = 0;
  Consume([&](const ImageFrame& frame) { EXPECT_EQ(frame.pixels.at<uint8_t>(3, 4), 50 + i++); });
  EXPECT_EQ(i, 3);
}

TEST_F(PlayTest, WaitsUntilTheFrontendIsReady) {
  StartPlayer(1);
  EXPECT_FALSE(bus_->WaitFor([this] { return images_->HasNews(); }, milliseconds(200)));
  int images = 0;
  Consume([&](const ImageFrame&) { ++images; });
  EXPECT_EQ(images, 1);
}

TEST_F(PlayTest, LosslessKeepsAFewImagesOnTheirWay) {
  options_.pace = Pace::kLossless;
  StartPlayer(9);
  frontend_status_->SetState(ProcessState::kReady);
  ASSERT_TRUE(bus_->WaitFor([this] { return images_->size() == 4; }, seconds(20)));
  EXPECT_FALSE(bus_->WaitFor([this] { return images_->size() > 4; }, milliseconds(150)))
      << "nobody is done with any image";
  int i = 0;
  Consume([&](const ImageFrame& frame) {
    EXPECT_EQ(frame.frame_seq, i);
    EXPECT_EQ(frame.pixels.at<uint8_t>(15, 31), 50 + i) << "a slot in use was written";
    ++i;
  });
  EXPECT_EQ(i, 9);
  EXPECT_EQ(sent_, 9);
}

TEST_F(PlayTest, RealtimeKeepsTheTempoWhoeverFollows) {
  options_.pace = Pace::kRealtime;
  constexpr int kFrames = 6;  // 0.1 s apart
  StartPlayer(kFrames);
  frontend_status_->SetState(ProcessState::kReady);
  ASSERT_TRUE(bus_->WaitFor([this] { return images_->HasNews(); }, seconds(20)));
  // Nothing is done with until the last one is there.
  ASSERT_TRUE(bus_->WaitFor([this] { return images_->size() == kFrames; }, seconds(20)));
  std::vector<int64_t> published_us;
  Consume([&](const ImageFrame& frame) { published_us.push_back(frame.published_us); });
  ASSERT_EQ(published_us.size(), static_cast<size_t>(kFrames));
  // A machine under load may be late with the first or the last of them.
  const int64_t span_us = published_us.back() - published_us.front();
  EXPECT_GT(span_us, 100'000 * (kFrames - 1) - 80'000);
  EXPECT_LT(span_us, 100'000 * (kFrames - 1) + 800'000);
  EXPECT_EQ(sent_, kFrames);
  EXPECT_EQ(error_, "");
}

TEST_F(PlayTest, RealtimeCanBeStoppedWhileItWaits) {
  options_.pace = Pace::kRealtime;
  StartPlayer(100000);
  int images = 0;
  Consume([&](const ImageFrame&) {
    if (++images == 3) stop_ = true;
    bus_->Notify();
  });
  EXPECT_EQ(sent_, 3);
}

TEST_F(PlayTest, StopsInOrder) {
  StartPlayer(100);
  int images = 0;
  Consume([&](const ImageFrame&) { stop_ = ++images == 4; });
  EXPECT_EQ(error_, "");
  EXPECT_EQ(sent_, 4);
}

TEST_F(PlayTest, ObeysTheStopCommand) {
  Publisher<Command> commands(*bus_, kCommandChannel);
  StartPlayer(1000);
  int images = 0;
  Consume([&](const ImageFrame&) {
    ++images;
    if (images == 2) commands.Publish({"frontend", CommandAction::kStop});  // not for the player
    if (images == 4) commands.Publish({"", CommandAction::kStop});
  });
  EXPECT_GE(images, 4);
  EXPECT_LT(images, 1000);
}

TEST_F(PlayTest, CanBeStoppedBeforeAnyoneIsReady) {
  StartPlayer(5);
  EXPECT_FALSE(bus_->WaitFor([] { return false; }, milliseconds(50)));
  stop_ = true;
  bus_->Notify();
  Consume([](const ImageFrame&) { ADD_FAILURE() << "no image was to be sent"; });
  EXPECT_EQ(sent_, 0);
}

TEST_F(PlayTest, ABrokenSourceStillEndsTheStream) {
  StartPlayer(10, 3);
  int images = 0;
  Consume([&](const ImageFrame&) { ++images; });
  EXPECT_EQ(images, 3);
  EXPECT_EQ(error_, "the source broke down");
}

TEST_F(PlayTest, GivesUpWhenTheFrontendFails) {
  StartPlayer(10);
  frontend_status_->SetState(ProcessState::kReady);
  ASSERT_TRUE(bus_->WaitFor([this] { return images_->HasNews(); }, seconds(20)));
  frontend_status_->SetState(ProcessState::kFailed, "out of luck");
  player_.join();
  EXPECT_NE(error_.find("frontend"), std::string::npos) << error_;
}

}  // namespace
}  // namespace vpslam
