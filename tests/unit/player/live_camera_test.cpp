#include "player/live_camera.h"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vpslam {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;

Camera SmallCamera() {
  Camera camera;
  camera.width = 64;
  camera.height = 48;
  camera.fx = camera.fy = 60;
  camera.cx = 31.5;
  camera.cy = 23.5;
  return camera;
}

cv::Mat Picture(int grey, int width = 64) {
  return cv::Mat(48, width, CV_8UC3, cv::Scalar::all(grey));
}

/// What a test makes the camera do.
class Script {
 public:
  void Add(const cv::Mat& pixels, int64_t stamp_us) { Push(CapturedFrame{pixels, stamp_us}); }
  void Vanish() { Push(std::nullopt); }
  /// All that was added was asked for, and the next is waited for.
  void WaitUntilWorkedOff() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return waiting_ && steps_.empty(); });
  }
  void WaitUntilTaken() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return taken_; });
  }
  std::optional<CapturedFrame> Take() {
    std::unique_lock lock(mutex_);
    waiting_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return !steps_.empty(); });
    waiting_ = false;
    auto step = steps_.front();
    steps_.pop_front();
    taken_ = true;
    changed_.notify_all();
    return step;
  }

 private:
  void Push(const std::optional<CapturedFrame>& step) {
    const std::lock_guard lock(mutex_);
    steps_.push_back(step);
    changed_.notify_all();
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::optional<CapturedFrame>> steps_;
  bool waiting_ = false;
  bool taken_ = false;
};

class ScriptedCapture : public FrameCapture {
 public:
  explicit ScriptedCapture(Script* script) : script_(script) {}
  std::string name() const override { return "/dev/video7"; }
  std::optional<CapturedFrame> Read() override { return script_->Take(); }

 private:
  Script* script_;
};

class LiveCameraTest : public ::testing::Test {
 protected:
  LiveCameraTest() {
    options_.tell = [this](const std::string& line) { told_.push_back(line); };
  }
  ~LiveCameraTest() override {
    script_.Vanish();  // lets the thread end
    source_.reset();
  }
  void Open() {
    source_ = MakeLiveCamera(std::make_unique<ScriptedCapture>(&script_), SmallCamera(),
                             "lens.yaml", options_);
  }
  std::string NextError() {
    try {
      source_->Next();
    } catch (const std::runtime_error& e) {
      return e.what();
    }
    return {};
  }

  Script script_;
  SourceOptions options_;
  std::vector<std::string> told_;
  std::unique_ptr<ImageSource> source_;
};

TEST_F(LiveCameraTest, DeliversGreyFramesAsTheyCome) {
  Open();
  EXPECT_TRUE(source_->IsLive());
  for (int i = 0; i < 3; ++i) {
    script_.Add(Picture(10 + i), 1'000 * i);
    const auto frame = source_->Next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->stamp_us, 1'000 * i);
    EXPECT_EQ(frame->grey.type(), CV_8UC1);
    EXPECT_EQ(frame->grey.at<uint8_t>(0, 0), 10 + i);
  }
  script_.Vanish();
  EXPECT_THAT(NextError(), AllOf(HasSubstr("/dev/video7"), HasSubstr("no more frames")));
  EXPECT_TRUE(source_->Report().skipped.empty());
  EXPECT_EQ(source_->Report().expected, 3);
}

TEST_F(LiveCameraTest, LeavesOutWhatCameMeanwhile) {
  Open();
  script_.Add(Picture(1), 1);
  ASSERT_TRUE(source_->Next());
  script_.WaitUntilWorkedOff();
  for (int i = 2; i <= 5; ++i) script_.Add(Picture(i), i);
  script_.WaitUntilWorkedOff();
  EXPECT_EQ(source_->Next()->stamp_us, 5);
  script_.Vanish();
  EXPECT_THAT(NextError(), HasSubstr("no more frames"));
  EXPECT_EQ(source_->Report().expected, 5);
  EXPECT_EQ(source_->Report().skipped.at("came while others were worked on"), 3);
}

TEST_F(LiveCameraTest, DeliversTheLastFrameBeforeItSaysThatTheCameraIsGone) {
  Open();
  script_.Add(Picture(1), 1);
  ASSERT_TRUE(source_->Next());
  script_.WaitUntilWorkedOff();
  script_.Add(Picture(2), 2);
  script_.Vanish();
  EXPECT_EQ(source_->Next()->stamp_us, 2);
  EXPECT_THAT(NextError(), HasSubstr("plugged in"));
}

TEST_F(LiveCameraTest, StopsWhereAskedTo) {
  options_.start = 2;
  options_.max_frames = 1;
  Open();
  for (int i = 0; i < 3; ++i) script_.Add(Picture(i), i);
  EXPECT_EQ(source_->Next()->stamp_us, 2);
  EXPECT_FALSE(source_->Next());
}

TEST_F(LiveCameraTest, SkipsSingleBadFrames) {
  Open();
  script_.Add(Picture(1), 1);
  ASSERT_TRUE(source_->Next());
  script_.Add(cv::Mat(), 2);
  script_.Add(Picture(3), 1);  // time stands still
  script_.Add(Picture(4), 4);
  EXPECT_EQ(source_->Next()->stamp_us, 4);
  script_.Vanish();
  EXPECT_NE(NextError(), "");
  ASSERT_THAT(told_, SizeIs(2));
  EXPECT_THAT(told_[0], AllOf(HasSubstr("frame 1"), HasSubstr("empty"), HasSubstr("skipped")));
  EXPECT_THAT(told_[1], HasSubstr("repeated time stamp"));
  EXPECT_EQ(source_->Report().skipped.at("is bad"), 2);
}

TEST_F(LiveCameraTest, GivesUpOnFramesOfAnotherSize) {
  Open();
  for (int i = 0; i < 3; ++i) script_.Add(Picture(1, 80), i);
  EXPECT_THAT(NextError(), AllOf(HasSubstr("80 x 48"), HasSubstr("64 x 48"), HasSubstr("lens.yaml"),
                                 HasSubstr("--camera")));
}

TEST_F(LiveCameraTest, EndsWhileTheCameraWaits) {
  Open();
  script_.Add(Picture(1), 1);
  ASSERT_TRUE(source_->Next());
  std::thread closing([this] { source_.reset(); });
  script_.Add(Picture(2), 2);
  script_.Vanish();  // should that frame have been taken before the end was asked for
  closing.join();
}

TEST_F(LiveCameraTest, ADriverThatHangsKeepsNobodyFromEnding) {
  Script script;
  LiveCameraPatience patience;
  patience.stalled = std::chrono::milliseconds(100);
  patience.stop = std::chrono::milliseconds(50);
  const auto start = std::chrono::steady_clock::now();
  source_ = MakeLiveCamera(std::make_unique<ScriptedCapture>(&script), SmallCamera(), "lens.yaml",
                           options_, patience);
  EXPECT_FALSE(source_->WaitReady(std::chrono::milliseconds(10)));
  EXPECT_THAT(NextError(), AllOf(HasSubstr("/dev/video7"), HasSubstr("no frame came for 0.1 s")));
  EXPECT_TRUE(source_->Report().skipped.empty());
  source_.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
  ASSERT_THAT(told_, SizeIs(1));
  EXPECT_THAT(told_[0], HasSubstr("driver does not answer"));
  script.Vanish();  // the thread that was left behind ends
  script.WaitUntilTaken();
}

TEST_F(LiveCameraTest, IsReadyOnceAFrameHasCome) {
  Open();
  EXPECT_FALSE(source_->WaitReady(std::chrono::milliseconds(20)));
  script_.Add(Picture(1), 1);
  EXPECT_TRUE(source_->WaitReady(std::chrono::seconds(5)));
  EXPECT_EQ(source_->Next()->stamp_us, 1);
  script_.Vanish();
  EXPECT_TRUE(source_->WaitReady(std::chrono::seconds(5))) << "the error is what came";
  EXPECT_NE(NextError(), "");
}

TEST(ScaledCamera, KeepsRays) {
  const Camera camera = SmallCamera();
  const Camera scaled = ScaledCamera(camera, 128, 96);
  EXPECT_EQ(scaled.fx, 120);
  // The upper left corner of the image, half a pixel outside the first pixel's centre.
  EXPECT_NEAR((scaled.Unproject({-0.5, -0.5}) - camera.Unproject({-0.5, -0.5})).norm(), 0, 1e-12);
  EXPECT_NEAR((scaled.Unproject({127.5, 95.5}) - camera.Unproject({63.5, 47.5})).norm(), 0, 1e-12);
  EXPECT_THROW(ScaledCamera(camera, 128, 72), std::runtime_error);
  Camera masked = camera;
  masked.mask_runs = {64 * 20, 64 * 28};
  EXPECT_EQ(ScaledCamera(masked, 128, 96).mask_runs, (std::vector<int32_t>{128 * 40, 128 * 56}));
}

TEST(LiveCamera, IsRecognised) {
  for (const char* name : {"camera:0", "camera:/dev/video2", "/dev/video0", "rtsp://host/stream"}) {
    EXPECT_TRUE(IsLiveCamera(name)) << name;
  }
  for (const char* name : {"camera", "/dev/shm", "clip.avi"})
    EXPECT_FALSE(IsLiveCamera(name)) << name;
}

}  // namespace
}  // namespace vpslam
