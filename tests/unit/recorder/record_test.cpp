#include "recorder/record.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/messages/command.h"
#include "core/messages/map_request.h"
#include "core/transport/channels.h"
#include "core/transport/inbox.h"
#include "core/transport/publisher.h"
#include "core/transport/stream_writer.h"
#include "tests/unit/recorder/synthetic_run.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

/// The recorder in a thread of its own; frontend and backend are played by the test, on one
/// in-process bus.
class RecordTest : public ::testing::Test {
 protected:
  RecordTest()
      : path_(fs::temp_directory_path() /
              fmt::format("vpslam_record_{}_{}", getpid(),
                          ::testing::UnitTest::GetInstance()->current_test_info()->name())),
        folder_(path_.string()) {
    BusOptions options;
    options.url = "memq://";
    bus_ = std::make_unique<Bus>(options);
    status_ = std::make_unique<StatusReporter>(*bus_, "recorder");
    const std::vector<std::string> consumers = {"recorder"};
    poses_ = std::make_unique<StreamWriter<FramePose>>(*bus_, kPoseChannel, consumers);
    deltas_ = std::make_unique<StreamWriter<MapDelta>>(*bus_, kMapChannel, consumers);
    recorder_ =
        std::make_unique<Recorder>(*bus_, *status_, folder_, RunInfo(),
                                   [this](const std::string& s) { progress_.push_back(s); });
    thread_ = std::thread([this] {
      try {
        complete_ = recorder_->Run(stop_);
      } catch (const std::exception& e) {
        error_ = e.what();
      }
    });
  }
  ~RecordTest() override {
    stop_ = true;
    bus_->Notify();
    Join();
    recorder_.reset();
    fs::remove_all(path_);
  }
  void Join() {
    if (thread_.joinable()) thread_.join();
  }
  std::string Read(const std::string& name) const {
    std::ifstream file(path_ / name);
    return {std::istreambuf_iterator<char>(file), {}};
  }
  MapDelta FirstDelta() const {
    MapDelta delta = MakeDelta(0);
    delta.keyframes = {MakeKeyframe(0, 0, 0, CamAt(0))};
    delta.answers = KeyframeId(0);
    return delta;
  }
  void SendPoses(int n) {
    for (int i = 0; i < n; ++i) ASSERT_TRUE(poses_->Send(MakePose(i, 0, 0, CamAt(i), CamAt(i))));
  }

  fs::path path_;
  ResultsFolder folder_;
  std::atomic<bool> stop_ = false;
  bool complete_ = false;
  std::string error_;
  std::vector<std::string> progress_;
  std::unique_ptr<Bus> bus_;
  std::unique_ptr<StatusReporter> status_;
  std::unique_ptr<StreamWriter<FramePose>> poses_;
  std::unique_ptr<StreamWriter<MapDelta>> deltas_;
  std::unique_ptr<Recorder> recorder_;
  std::thread thread_;
};

TEST_F(RecordTest, WritesResultsWhenBothStreamsHaveEnded) {
  ASSERT_TRUE(deltas_->Send(FirstDelta()));
  SendPoses(20);
  ASSERT_TRUE(poses_->SendEnd());
  ASSERT_TRUE(poses_->WaitAllAcked(seconds(10)));
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_FALSE(fs::exists(path_ / "trajectory.txt"));
  ASSERT_TRUE(deltas_->SendEnd());
  Join();
  EXPECT_TRUE(complete_);
  const std::string trajectory = Read("trajectory.txt");
  EXPECT_EQ(std::count(trajectory.begin(), trajectory.end(), '\n'), 20);
  EXPECT_EQ(Read("live_trajectory.txt"), trajectory);
  const auto summary = nlohmann::json::parse(Read("summary.json"));
  EXPECT_EQ(summary["frames"]["tracked"], 20);
  EXPECT_EQ(summary["keyframes"], 1);
  EXPECT_GT(summary["peak_rss_mb"]["recorder"], 0);
  ASSERT_FALSE(progress_.empty());
  EXPECT_EQ(nlohmann::json::parse(progress_.back())["frame"], 19);
}

TEST_F(RecordTest, AsksForASnapshotWhenADeltaDoesNotFit) {
  Inbox<MapRequest> requests(*bus_, kMapRequestChannel, Inbox<MapRequest>::kUnbounded);
  MapDelta late = FirstDelta();
  late.base_version = 7;
  late.version = 8;
  ASSERT_TRUE(deltas_->Send(late));
  ASSERT_TRUE(bus_->WaitFor([&] { return requests.HasMessage(); }, seconds(10)));
  const MapRequest request = requests.TryTake()->value;
  EXPECT_EQ(request.process, "recorder");
  EXPECT_EQ(request.map_version, 0);
  MapDelta snapshot = FirstDelta();
  snapshot.snapshot = true;
  snapshot.version = 8;
  ASSERT_TRUE(deltas_->Send(snapshot));
  MapDelta next = MakeDelta(8);
  next.keyframes = {MakeKeyframe(1, 0, 1, CamAt(1))};
  ASSERT_TRUE(deltas_->Send(next));
  ASSERT_TRUE(deltas_->SendEnd());
  ASSERT_TRUE(poses_->SendEnd());
  Join();
  const std::string keyframes = Read("keyframes.txt");
  EXPECT_EQ(std::count(keyframes.begin(), keyframes.end(), '\n'), 2);
}

TEST_F(RecordTest, AsksForAnotherSnapshotWhenOneBreaksOff) {
  Inbox<MapRequest> requests(*bus_, kMapRequestChannel, Inbox<MapRequest>::kUnbounded);
  MapDelta first_part = FirstDelta();
  first_part.snapshot = true;
  first_part.version = -1;
  ASSERT_TRUE(deltas_->Send(first_part));
  MapDelta of_another_backend = FirstDelta();
  of_another_backend.base_version = 7;
  of_another_backend.version = 8;
  ASSERT_TRUE(deltas_->Send(of_another_backend));
  ASSERT_TRUE(bus_->WaitFor([&] { return requests.HasMessage(); }, seconds(10)));
  EXPECT_EQ(requests.TryTake()->value.map_version, 0);
  MapDelta snapshot = FirstDelta();
  snapshot.snapshot = true;
  snapshot.version = 8;
  ASSERT_TRUE(deltas_->Send(snapshot));
  ASSERT_TRUE(deltas_->SendEnd());
  ASSERT_TRUE(poses_->SendEnd());
  Join();
  EXPECT_TRUE(complete_);
  const std::string keyframes = Read("keyframes.txt");
  EXPECT_EQ(std::count(keyframes.begin(), keyframes.end(), '\n'), 1);
}

TEST_F(RecordTest, SavesOnCommandAndGoesOn) {
  Publisher<Command> commands(*bus_, kCommandChannel);
  ASSERT_TRUE(deltas_->Send(FirstDelta()));
  SendPoses(3);
  ASSERT_TRUE(poses_->WaitAllAcked(seconds(10)));
  commands.Publish({"recorder", CommandAction::kSaveNow});
  for (int i = 0; i < 1000 && !fs::exists(path_ / "trajectory.txt"); ++i) {
    std::this_thread::sleep_for(milliseconds(10));
  }
  EXPECT_EQ(Read("trajectory.txt").substr(0, 10), "0.000000 0");
  ASSERT_TRUE(poses_->Send(MakePose(3, 0, 0, CamAt(3), CamAt(3))));
  ASSERT_TRUE(poses_->SendEnd());
  ASSERT_TRUE(deltas_->SendEnd());
  Join();
  EXPECT_TRUE(complete_);
  EXPECT_THAT(Read("trajectory.txt"), HasSubstr("\n0.300000 3.0"));
}

TEST_F(RecordTest, EndsWhenAllOthersHaveGone) {
  ASSERT_TRUE(deltas_->Send(FirstDelta()));
  SendPoses(2);
  ASSERT_TRUE(poses_->WaitAllAcked(seconds(10)));
  StatusReporter player(*bus_, "player"), frontend(*bus_, "frontend");
  frontend.SetState(ProcessState::kFailed, "out of memory");
  std::this_thread::sleep_for(milliseconds(300));
  EXPECT_EQ(status_->Snapshot().state, ProcessState::kRunning) << "the player may start another";
  player.SetState(ProcessState::kFailed, "frontend failed");
  Join();
  EXPECT_FALSE(complete_);
  EXPECT_THAT(Read("trajectory.txt"), HasSubstr("\n0.100000 1.0"));
}

TEST_F(RecordTest, WhatAHandlerThrowsEndsItWithResults) {
  ASSERT_TRUE(deltas_->Send(FirstDelta()));
  SendPoses(2);
  ASSERT_TRUE(poses_->WaitAllAcked(seconds(10)));
  std::this_thread::sleep_for(milliseconds(300));  // until they are worked in
  const auto timer = bus_->OnTick([] { throw std::runtime_error("a handler is broken"); });
  Join();
  EXPECT_EQ(error_, "a handler is broken");
  EXPECT_THAT(Read("trajectory.txt"), HasSubstr("\n0.100000 1.0"));
}

TEST_F(RecordTest, WritesWhatItHasWhenStopped) {
  ASSERT_TRUE(deltas_->Send(FirstDelta()));
  SendPoses(2);
  ASSERT_TRUE(poses_->WaitAllAcked(seconds(10)));
  stop_ = true;
  bus_->Notify();
  Join();
  EXPECT_FALSE(complete_);
  EXPECT_THAT(Read("trajectory.txt"), HasSubstr("\n0.100000 1.0"));
}

}  // namespace
}  // namespace vpslam
