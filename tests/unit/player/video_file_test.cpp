#include "player/video_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/videoio.hpp>

#include "tests/unit/player/sequence_folder.h"

namespace vpslam {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// YUV4MPEG2 files, which hold plain pixels: frame i has the grey value 20 + 10 i.
class VideoFile : public SequenceFolderTest {
 protected:
  void SetUp() override {
    SequenceFolderTest::SetUp();
    Write("camera.yaml", kSmallCamera);
    options_.camera_file = (folder_ / "camera.yaml").string();
  }
  void WriteVideo(int frames, int width = 64, int height = 48) {
    std::string video = fmt::format("YUV4MPEG2 W{} H{} F25:1 Ip A1:1 C444\n", width, height);
    for (int i = 0; i < frames; ++i) {
      const auto pixels = static_cast<size_t>(width) * height;
      video += "FRAME\n" + std::string(pixels, static_cast<char>(20 + 10 * i)) +
               std::string(2 * pixels, static_cast<char>(128));
    }
    Write("clip.y4m", video);
  }
  std::vector<SourceFrame> Play() {
    const auto source = OpenSource((folder_ / "clip.y4m").string(), options_);
    std::vector<SourceFrame> frames;
    while (auto frame = source->Next()) frames.push_back(std::move(*frame));
    report_ = source->Report();
    return frames;
  }
  std::string PlayError() {
    try {
      Play();
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return {};
  }
};

TEST_F(VideoFile, PlaysWithTheTimeStampsOfTheFile) {
  WriteVideo(6);
  const auto frames = Play();
  ASSERT_EQ(frames.size(), 6u);
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(frames[i].stamp_us, 40'000 * i);
    ASSERT_EQ(frames[i].grey.type(), CV_8UC1);
    // Video range 16 to 235 becomes 0 to 255.
    EXPECT_NEAR(frames[i].grey.at<uint8_t>(7, 6), (20 + 10 * i - 16) * 255.0 / 219, 2);
  }
  EXPECT_EQ(report_.expected, 6);
  EXPECT_TRUE(report_.skipped.empty());
  EXPECT_TRUE(report_.notes.empty());
}

TEST_F(VideoFile, TakesPartsAndAnotherRate) {
  WriteVideo(6);
  options_.start = 2;
  options_.max_frames = 3;
  options_.fps = 10;
  const auto frames = Play();
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].stamp_us, 200'000);
  EXPECT_EQ(frames[2].stamp_us, 400'000);
  EXPECT_NEAR(frames[0].grey.at<uint8_t>(0, 0), 24 * 255.0 / 219, 2);
}

TEST_F(VideoFile, TellsWhatIsMissingAtTheEnd) {
  const std::string path = (folder_ / "clip.y4m").string() + ".avi";
  cv::VideoWriter writer(path, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 25,
                         {64, 48});
  if (!writer.isOpened()) GTEST_SKIP() << "no encoder";
  cv::Mat noise(48, 64, CV_8UC3);
  for (int i = 0; i < 40; ++i) {
    cv::randu(noise, 0, 255);
    writer.write(noise);
  }
  writer.release();
  const auto play = [&] {
    const auto source = OpenSource(path, options_);
    int64_t frames = 0;
    while (source->Next()) ++frames;
    report_ = source->Report();
    return frames;
  };
  EXPECT_EQ(play(), 40);
  EXPECT_EQ(report_.expected, 40);
  EXPECT_TRUE(report_.skipped.empty());
  EXPECT_TRUE(report_.notes.empty());
  Truncate("clip.y4m.avi", 0.6);
  const int64_t played = play();
  EXPECT_GT(played, 10);
  EXPECT_LT(played, 30);
  EXPECT_EQ(report_.expected, 40);
  EXPECT_EQ(report_.skipped.at("missing or damaged in the file"), 40 - played);
  EXPECT_THAT(report_.notes, ::testing::ElementsAre(HasSubstr("is truncated or damaged")));
  // A part that was asked for, and a stop by hand, are no loss.
  options_.max_frames = 5;
  EXPECT_EQ(play(), 5);
  EXPECT_EQ(report_.expected, 5);
  EXPECT_TRUE(report_.skipped.empty());
  options_.max_frames = 0;
  const auto source = OpenSource(path, options_);
  source->Next();
  EXPECT_EQ(source->Report().expected, 40);
  EXPECT_TRUE(source->Report().skipped.empty());
}

TEST_F(VideoFile, NamesWhatIsWrong) {
  WriteVideo(5);
  options_.start = 5;
  EXPECT_THAT(PlayError(), AllOf(HasSubstr("clip.y4m"), HasSubstr("earlier")));
  options_.start = 0;
  WriteVideo(5, 32, 48);
  EXPECT_THAT(PlayError(),
              AllOf(HasSubstr("32 x 48"), HasSubstr("64 x 48"), HasSubstr("--camera")));
  Write("clip.y4m", "no video at all");
  EXPECT_THAT(PlayError(), AllOf(HasSubstr("clip.y4m"), HasSubstr("is a text file")));
  WriteVideo(0);
  EXPECT_THAT(PlayError(), HasSubstr("clip.y4m"));
  WriteVideo(5);
  options_.camera_file.clear();
  EXPECT_THAT(PlayError(), AllOf(HasSubstr("clip.y4m"), HasSubstr("--camera")));
}

}  // namespace
}  // namespace vpslam
