#include "recorder/message_log.h"

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/messages/frame_features.h"
#include "core/messages/keyframe_proposal.h"
#include "core/messages/truth.h"
#include "core/transport/camera_link.h"
#include "core/transport/channels.h"
#include "core/transport/event_log.h"
#include "core/transport/image_pool.h"
#include "core/transport/stream_writer.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;
using std::chrono::seconds;

constexpr int kFrames = 40;
constexpr int kWidth = 32, kHeight = 16;

Camera SmallCamera() {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = 30;
  camera.cx = 15;
  camera.cy = 7;
  return camera;
}

/// A run whose streams this test writes, and its log, on a bus that loses messages.
class MessageLogTest : public ::testing::TestWithParam<double> {
 protected:
  MessageLogTest()
      : path_(fs::temp_directory_path() / fmt::format("vpslam_message_log_{}.lcm", getpid())) {
    BusOptions options;
    options.url = "memq://";
    options.drop_share = GetParam();
    bus_ = std::make_unique<Bus>(options);
  }
  ~MessageLogTest() override { fs::remove(path_); }

  MessageLogOptions Options(bool pixels) const {
    return {path_.string(), pixels, {7, "abc", "{\"preset\": \"points\"}"}};
  }
  StreamWriterOptions Window() const {
    StreamWriterOptions options;
    options.window = 2;
    return options;
  }

  /// Sends a run of kFrames to the log until all is acknowledged, then closes it.
  void Run(MessageLog& log) {
    const std::vector<std::string> recorder = {"recorder"};
    StreamWriter<ImageMessage> images(*bus_, kImageChannel, recorder, Window());
    StreamWriter<FrameFeatures> features(*bus_, kFeaturesChannel, recorder, Window());
    StreamWriter<Truth> truths(*bus_, kTruthChannel, recorder, Window());
    StreamWriter<KeyframeProposal> keyframes(*bus_, kKeyframeChannel, recorder, Window());
    ImagePool pool(ImageSegmentName(bus_->session()), 3, kWidth * kHeight);
    CameraBeacon camera(*bus_, SmallCamera());
    for (int i = 0; i < kFrames; ++i) {
      ImageFrame image;
      image.frame_seq = i;
      image.pixels = cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(i));
      ASSERT_TRUE(images.WaitForRoom());
      ASSERT_TRUE(images.Send(pool.Store(image)));
      FrameFeatures found;
      found.frame_seq = i;
      ASSERT_TRUE(features.Send(found));
      ASSERT_TRUE(truths.Send({i, i, SE3()}));
    }
    ASSERT_TRUE(images.SendEnd() && features.SendEnd() && truths.SendEnd() && keyframes.SendEnd());
    ASSERT_TRUE(images.WaitAllAcked(seconds(20)) && features.WaitAllAcked(seconds(20)) &&
                truths.WaitAllAcked(seconds(20)) && keyframes.WaitAllAcked(seconds(20)));
    ASSERT_TRUE(bus_->WaitFor([&] { return log.StreamsEnded(); }, seconds(20)));
    log.Close();
  }

  std::vector<LogEvent> Events() const {
    EventLogReader reader(path_.string());
    std::vector<LogEvent> events;
    while (auto event = reader.Next()) events.push_back(*std::move(event));
    return events;
  }

  const fs::path path_;
  std::unique_ptr<Bus> bus_;
};

TEST_P(MessageLogTest, HoldsEachMessageOfTheStreamsOnceAndInOrder) {
  MessageLog log(*bus_, Options(true));
  Run(log);
  ASSERT_FALSE(HasFatalFailure());
  EXPECT_FALSE(log.error());
  for (const char* channel : {kImageChannel, kFeaturesChannel, kTruthChannel}) {
    EXPECT_EQ(log.counts().at(channel).messages, kFrames + 1) << channel;  // with the end
    EXPECT_EQ(log.counts().at(channel).gaps, 0) << channel;
  }
  const std::vector<LogEvent> events = Events();
  ASSERT_GT(events.size(), 2u);
  EXPECT_EQ(events[0].channel, kCameraChannel) << "the log begins with the camera";
  EXPECT_EQ(events[1].channel, kRunChannel);
  std::string why;
  const auto run = Decode<RunDescription>(events[1].bytes, &why);
  ASSERT_TRUE(run) << why;
  EXPECT_EQ(run->value.seed, 7u);
  EXPECT_EQ(run->value.options, "{\"preset\": \"points\"}");
  int next_image = 0, next_features = 0;
  for (const LogEvent& event : events) {
    if (event.channel == kImageChannel) {
      const auto image = Decode<ImageMessage>(event.bytes, &why);
      ASSERT_TRUE(image) << why;
      if (image->header.last) continue;
      EXPECT_EQ(image->value.frame_seq, next_image);
      EXPECT_EQ(image->value.bytes,
                std::vector<uint8_t>(kWidth * kHeight, static_cast<uint8_t>(next_image)));
      ++next_image;
    } else if (event.channel == kFeaturesChannel) {
      const auto features = Decode<FrameFeatures>(event.bytes, &why);
      ASSERT_TRUE(features) << why;
      if (features->header.last) continue;
      EXPECT_EQ(features->value.frame_seq, next_features++);
    }
  }
  EXPECT_EQ(next_image, kFrames);
  EXPECT_EQ(next_features, kFrames);
}

TEST_P(MessageLogTest, WhatFindsNoRoomIsLeftOutAndCounted) {
  MessageLogOptions options = Options(true);
  options.max_waiting_bytes = 0;
  MessageLog log(*bus_, options);
  EXPECT_EQ(log.left_out(), 0);
  Run(log);
  ASSERT_FALSE(HasFatalFailure()) << "its writer waits for ever";
  EXPECT_GE(log.left_out(), kFrames);
  for (const LogEvent& event : Events()) EXPECT_NE(event.channel, kFeaturesChannel);
}

INSTANTIATE_TEST_SUITE_P(WithAndWithoutLosses, MessageLogTest, ::testing::Values(0.0, 0.1));

TEST(MessageLogFile, OneThatCannotBeWrittenIsGivenUpAndTold) {
  if (!fs::exists("/dev/full")) GTEST_SKIP();
  BusOptions options;
  options.url = "memq://";
  Bus bus(options);
  MessageLog log(bus, {"/dev/full", false, {}});
  CameraBeacon camera(bus, SmallCamera());
  StreamWriterOptions window;
  window.window = 2;
  StreamWriter<FrameFeatures> features(bus, kFeaturesChannel, {"recorder"}, window);
  FrameFeatures many;
  many.features.keypoints.resize(1000);
  many.features.descriptors.resize(1000);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(features.Send(many));
  EXPECT_TRUE(features.WaitAllAcked(seconds(20))) << "the run goes on";
  log.Close();
  ASSERT_TRUE(log.error());
  EXPECT_NE(log.error()->find("/dev/full: cannot be written"), std::string::npos);
}

}  // namespace
}  // namespace vpslam
