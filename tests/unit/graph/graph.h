// A whole graph in one process: a player, the real loops of frontend and backend around fakes, and
// a recorder, over memq.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "core/transport/channels.h"
#include "core/transport/clock.h"
#include "fakes.h"

namespace vpslam::test {

using namespace std::chrono_literals;

inline constexpr int kFrames = 23;
inline constexpr int kKeyframes = 5;  // of frames 4 (two of them), 9, 14, 19

inline Camera SmallCamera() {
  Camera camera;
  camera.width = 32;
  camera.height = 24;
  camera.fx = camera.fy = 30;
  camera.cx = 16;
  camera.cy = 12;
  return camera;
}

class Graph {
 public:
  explicit Graph(double drop_share = 0, uint64_t drop_seed = 1, Pace pace = Pace::kLockstep)
      : pace_(pace),
        bus_(Options(drop_share, drop_seed)),
        peers_(bus_),
        player_status_(bus_, "player"),
        recorder_status_(bus_, "recorder"),
        poses_(bus_, kPoseChannel, "recorder", AckPolicy::kOnReceipt),
        map_(bus_, kMapChannel, "recorder", AckPolicy::kOnReceipt) {
    recorder_status_.SetState(ProcessState::kReady);
  }
  ~Graph() {
    bus_.Interrupt();
    for (std::thread& thread : threads_) thread.join();
  }

  void StartBackend() {
    threads_.emplace_back([this] {
      StatusReporter status(bus_, "backend");
      status.AddProcessed(static_cast<int64_t>(mapper_.keyframes_.size()));
      BackendProcess backend(bus_, peers_, status, {"frontend", "recorder"}, pace_,
                             [this](const Camera&) { return mapper_.Calls(); });
      Guard([&] { backend.Run(); });
      backend_done_ = true;
      bus_.Notify();
    });
  }
  void StartFrontend() {
    threads_.emplace_back([this] {
      StatusReporter status(bus_, "frontend");
      FrontendProcess frontend(
          bus_, peers_, status, {"backend", "recorder"},
          [this](const Camera&) -> TrackerInterface& { return tracker_; }, std::nullopt, pace_);
      Guard([&] { frontend.Run(); });
      frontend_done_ = true;
      bus_.Notify();
    });
  }

  /// Plays the sequence and waits until all have ended. In realtime an image follows each `period`.
  void Play(std::chrono::milliseconds period = 0ms) {
    ASSERT_TRUE(peers_.WaitReady({"frontend", "backend"}, 5s));
    CameraBeacon camera(bus_, SmallCamera());
    StreamWriterOptions options;
    options.window = 2;
    options.drop_oldest = pace_ == Pace::kRealtime;
    StreamWriter<ImageMessage> images(bus_, kImageChannel, {"frontend"}, options);
    ImagePool pool(ImageSegmentName(bus_.session()), pace_ == Pace::kRealtime ? kFrames : 3,
                   32 * 24);
    for (int i = 0; i < kFrames; ++i) {
      ImageFrame frame;
      frame.frame_seq = i;
      frame.stamp_us = 33333 * i;
      frame.published_us = MonotonicMicroseconds();
      frame.decode_ms = 0.5;
      frame.pixels = cv::Mat(24, 32, CV_8UC1, cv::Scalar(i));
      ASSERT_TRUE(images.WaitForRoom());
      ASSERT_TRUE(images.Send(pool.Store(frame)));
      std::this_thread::sleep_for(period);
    }
    ASSERT_TRUE(images.SendEnd());
    ASSERT_TRUE(images.WaitAllAcked(20s));
    ASSERT_TRUE(bus_.WaitFor([&] { return frontend_done_ && backend_done_; }, 20s));
  }

  std::vector<FramePose> RecordedPoses() {
    std::vector<FramePose> poses;
    while (auto item = poses_.TryTake()) poses.push_back(item->value);
    return poses;
  }

  const Pace pace_;
  Bus bus_;
  Peers peers_;
  StatusReporter player_status_;
  StatusReporter recorder_status_;
  StreamReader<FramePose> poses_;
  StreamReader<MapDelta> map_;
  FakeTracker tracker_;
  FakeMapper mapper_;
  std::atomic<bool> frontend_done_{false}, backend_done_{false};
  std::string error_;

 private:
  static BusOptions Options(double drop_share, uint64_t drop_seed) {
    BusOptions options;
    options.url = "memq://";
    options.drop_share = drop_share;
    options.drop_seed = drop_seed;
    return options;
  }
  void Guard(const std::function<void()>& body) {
    try {
      body();
    } catch (const std::exception& e) {
      const std::lock_guard lock(error_mutex_);
      error_ = e.what();
    }
  }

  std::mutex error_mutex_;
  std::vector<std::thread> threads_;
};

}  // namespace vpslam::test
