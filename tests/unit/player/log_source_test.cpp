#include "player/log_source.h"

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/messages/truth.h"
#include "core/transport/channels.h"
#include "core/transport/codec.h"
#include "core/transport/event_log.h"
#include "core/transport/image_message.h"
#include "player/source_factory.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr int kFrames = 5;

class LogSourceTest : public ::testing::Test {
 protected:
  LogSourceTest()
      : path_((fs::temp_directory_path() / fmt::format("vpslam_log_source_{}.lcm", getpid()))
                  .string()),
        log_(std::make_unique<EventLogWriter>(path_)) {}
  ~LogSourceTest() override { fs::remove(path_); }

  template <class T>
  void Write(const char* channel, const T& value, int64_t seq, bool last = false) {
    Header header;
    header.session = 5;
    header.seq = header.oldest_seq = seq;
    header.last = last;
    log_->Write(0, channel, Encode(header, value));
  }
  void WriteCamera() {
    Camera camera;
    camera.width = 32;
    camera.height = 16;
    camera.fx = camera.fy = 30;
    camera.cx = 15;
    camera.cy = 7;
    Write(kCameraChannel, camera, 0);
  }
  void WriteImage(int i, bool handle = false) {
    ImageFrame frame;
    frame.frame_seq = i;
    frame.stamp_us = 1000 * i;
    frame.pixels = cv::Mat(16, 32, CV_8UC1, cv::Scalar(10 * i));
    ImageMessage message = InlineImage(frame);
    if (handle) {
      message.bytes.clear();
      message.segment = "/vpslam-1";
      message.generation = 2;
    }
    Write(kImageChannel, message, i);
  }
  void WriteFeatures(int i) {
    FrameFeatures features;
    features.frame_seq = i;
    features.stamp_us = 1000 * i;
    features.features.keypoints.resize(i);
    features.features.descriptors.resize(i);
    auto lines = std::make_shared<LineSet>();
    lines->lines.resize(1);
    if (i % 2 == 1) features.lines = lines;
    Write(kFeaturesChannel, features, i);
  }
  std::unique_ptr<ImageSource> Open(const SourceOptions& options = {}) {
    log_.reset();  // to the file
    return OpenSource(path_, options);
  }

  const std::string path_;
  std::unique_ptr<EventLogWriter> log_;
};

TEST_F(LogSourceTest, PlaysImagesWithTheirTruth) {
  WriteCamera();
  for (int i = 0; i < kFrames; ++i) {
    Write(kTruthChannel, Truth{i, 1000 * i, SE3(Eigen::Quaterniond::Identity(), {1. * i, 0, 0})},
          i);
    WriteImage(i);
    WriteImage(i);  // what was sent again is played once
    WriteFeatures(i);
  }
  const auto source = Open();
  EXPECT_FALSE(source->HasFeatures());
  EXPECT_EQ(source->camera().width, 32);
  for (int i = 0; i < kFrames; ++i) {
    const auto frame = source->Next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->stamp_us, 1000 * i);
    EXPECT_EQ(frame->grey.at<uint8_t>(1, 3), 10 * i);
    EXPECT_EQ(source->WorldFromCam(frame->stamp_us)->translation.x(), i);
  }
  EXPECT_FALSE(source->Next());
  EXPECT_EQ(source->Report().expected, kFrames);
  EXPECT_TRUE(source->Report().skipped.empty());
}

TEST_F(LogSourceTest, PlaysFeaturesAndLinesWithoutImagesOrWhenAsked) {
  for (const bool with_images : {false, true}) {
    log_ = std::make_unique<EventLogWriter>(path_);
    WriteCamera();
    for (int i = 0; i < kFrames; ++i) {
      if (with_images) WriteImage(i);
      WriteFeatures(i);
    }
    SourceOptions options;
    options.features = with_images;
    options.start = 1;
    options.max_frames = 3;
    const auto source = Open(options);
    EXPECT_TRUE(source->HasFeatures());
    for (int i = 1; i <= 3; ++i) {
      const auto frame = source->Next();
      ASSERT_TRUE(frame && frame->features);
      EXPECT_EQ(frame->stamp_us, 1000 * i);
      EXPECT_EQ(frame->features->features.size(), i);
      EXPECT_EQ(frame->features->lines != nullptr, i % 2 == 1);
    }
    EXPECT_FALSE(source->Next());
  }
}

TEST_F(LogSourceTest, LeavesOutDamagedMessages) {
  WriteCamera();
  WriteImage(0);
  log_->Write(0, kImageChannel, std::vector<uint8_t>(100, 7));
  WriteImage(1);
  const auto source = Open();
  EXPECT_EQ(source->Next()->stamp_us, 0);
  EXPECT_EQ(source->Next()->stamp_us, 1000);
  EXPECT_FALSE(source->Next());
  EXPECT_EQ(source->Report().without_end, path_ + " is cut off");
}

TEST_F(LogSourceTest, CountsWhatIsMissing) {
  WriteCamera();
  for (const int i : {0, 1, 3, 4, 7}) WriteImage(i);
  log_->Write(0, kImageChannel, std::vector<uint8_t>(100, 7));  // one of those that are missing
  Write(kImageChannel, ImageMessage(), 8, /*last=*/true);
  const auto source = Open();
  int frames = 0;
  while (source->Next()) ++frames;
  EXPECT_EQ(frames, 5);
  const SourceReport report = source->Report();
  EXPECT_EQ(report.expected, 8);
  EXPECT_EQ(report.skipped.at("missing in the log"), 2);
  EXPECT_EQ(report.skipped.at("damaged in the log"), 1);
  EXPECT_EQ(report.without_end, "");
}

TEST_F(LogSourceTest, PlaysInOrderOfTime) {
  WriteCamera();
  for (const int i : {0, 1, 4, 3, 2, 5, 6, 7}) WriteImage(i);
  const auto source = Open();
  for (int i = 0; i < 8; ++i) EXPECT_EQ(source->Next()->stamp_us, 1000 * i);
  EXPECT_FALSE(source->Next());
}

TEST_F(LogSourceTest, GoesOnBehindForeignBytes) {
  WriteCamera();
  for (int i = 0; i < 4; ++i) WriteImage(i);
  log_.reset();
  std::ofstream(path_, std::ios::app | std::ios::binary) << "123456789";
  const std::string first = path_ + ".first";
  fs::rename(path_, first);
  log_ = std::make_unique<EventLogWriter>(path_);
  for (int i = 4; i < 8; ++i) WriteImage(i);
  log_.reset();
  std::ofstream(first, std::ios::app | std::ios::binary)
      << std::ifstream(path_, std::ios::binary).rdbuf();
  fs::rename(first, path_);
  const auto source = OpenSource(path_, {});
  for (int i = 0; i < 8; ++i) EXPECT_EQ(source->Next()->stamp_us, 1000 * i);
  EXPECT_THAT(source->Report().notes, ::testing::ElementsAre(HasSubstr("9 bytes in 1 places")));
}

TEST_F(LogSourceTest, SaysWhatIsWrong) {
  const auto reason = [](const std::string& why) {
    return ThrowsMessage<std::runtime_error>(HasSubstr(why));
  };
  WriteImage(0);
  EXPECT_THAT([&] { Open(); }, reason("holds no camera"));
  log_ = std::make_unique<EventLogWriter>(path_);
  WriteCamera();
  EXPECT_THAT([&] { Open(); }, reason("neither images nor features"));
  log_ = std::make_unique<EventLogWriter>(path_);
  WriteCamera();
  WriteImage(0, true);
  EXPECT_THAT([&] { Open(); }, reason("were in shared memory and are gone"));
  log_ = std::make_unique<EventLogWriter>(path_);
  WriteCamera();
  WriteImage(0);
  SourceOptions options;
  options.start = 1;
  EXPECT_THAT([&] { Open(options); }, reason("--start 1 leaves none"));
  options = {};
  options.features = true;
  EXPECT_THAT([&] { OpenSource(path_, options); }, reason("holds no features"));
}

}  // namespace
}  // namespace vpslam
