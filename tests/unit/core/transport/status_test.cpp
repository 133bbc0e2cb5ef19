#include <mutex>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/transport/camera_link.h"
#include "core/transport/channels.h"
#include "core/transport/peers.h"
#include "core/transport/status_reporter.h"
#include "core/transport/stream_writer.h"
#include "random_messages.h"

namespace vpslam::test {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

BusOptions Memory() {
  BusOptions options;
  options.url = "memq://";
  return options;
}

TEST(Status, TellsStateWorkAndResources) {
  Bus bus(Memory());
  Peers peers(bus);
  StatusReporter reporter(bus, "frontend");
  EXPECT_TRUE(bus.WaitFor([&] { return peers.Get("frontend").has_value(); }, 2s));
  EXPECT_EQ(peers.Get("frontend")->state, ProcessState::kStarting);
  EXPECT_EQ(peers.Get("backend"), std::nullopt);
  reporter.AddProcessed(5);
  reporter.SetQueued(2);
  ++bus.counters().rejected;
  reporter.SetState(ProcessState::kRunning, "on its way");
  EXPECT_TRUE(
      bus.WaitFor([&] { return peers.Get("frontend")->state == ProcessState::kRunning; }, 2s));
  const ProcessStatus status = *peers.Get("frontend");
  EXPECT_EQ(status.processed, 5);
  EXPECT_EQ(status.queued, 2);
  EXPECT_EQ(status.rejected, 1);
  EXPECT_EQ(status.message, "on its way");
  EXPECT_EQ(status.protocol_version, kProtocolVersion);
  EXPECT_GT(status.pid, 0);
  int64_t waiting = 7;
  {
    const auto queue = reporter.WatchQueue([&waiting] { return waiting; });
    waiting = 8;
    EXPECT_EQ(reporter.Snapshot().queued, 8);
    waiting = 3;
  }
  waiting = 9;
  EXPECT_EQ(reporter.Snapshot().queued, 3);
  EXPECT_GT(status.cpu_s, 0);
  EXPECT_GT(status.rss_peak_mb, 1);
  EXPECT_LT(status.rss_peak_mb, 10000);
}

TEST(Status, IsRepeatedEverySecond) {
  Bus bus(Memory());
  StatusReporter reporter(bus, "frontend");
  Peers peers(bus);  // too late for the first
  EXPECT_TRUE(bus.WaitFor([&] { return peers.Get("frontend").has_value(); }, 3s));
}

TEST(Status, AnyTextCanBeReported) {
  Bus bus(Memory());
  Peers peers(bus);
  StatusReporter reporter(bus, "frontend");
  reporter.SetState(ProcessState::kFailed, std::string(5000, 'x') + std::string("\0", 1));
  EXPECT_TRUE(bus.WaitFor(
      [&] {
        const auto status = peers.Get("frontend");
        return status && status->state == ProcessState::kFailed;
      },
      2s));
}

TEST(Peers, AreAwaitedUntilAllAreReady) {
  Bus bus(Memory());
  Peers peers(bus);
  StatusReporter frontend(bus, "frontend"), backend(bus, "backend");
  frontend.SetState(ProcessState::kReady);
  EXPECT_FALSE(peers.WaitReady({"frontend", "backend"}, 100ms));
  EXPECT_THAT(peers.NotReady({"frontend", "backend"}), ElementsAre("backend"));
  std::thread starter([&] {
    std::this_thread::sleep_for(50ms);
    backend.SetState(ProcessState::kReady);
  });
  EXPECT_TRUE(peers.WaitReady({"frontend", "backend"}, 5s));
  starter.join();
}

TEST(Peers, FailureAndSilenceAreTold) {
  Bus bus(Memory());
  Peers peers(bus, 200ms);
  EXPECT_FALSE(peers.WhyGone("backend")) << "who was never heard may still come";
  {
    StatusReporter backend(bus, "backend");
    backend.SetState(ProcessState::kRunning);
    ASSERT_TRUE(bus.WaitFor([&] { return peers.Get("backend").has_value(); }, 2s));
    EXPECT_FALSE(peers.WhyGone("backend"));
  }
  std::this_thread::sleep_for(300ms);
  ASSERT_TRUE(peers.WhyGone("backend"));
  EXPECT_THAT(*peers.WhyGone("backend"), HasSubstr("silent"));
  EXPECT_THROW(peers.WaitFor([] { return false; }, {"backend"}), PeerGoneError);
  EXPECT_TRUE(peers.WaitFor([] { return true; }, {"backend"}));

  StatusReporter frontend(bus, "frontend");
  frontend.SetState(ProcessState::kFailed, "out of film");
  ASSERT_TRUE(bus.WaitFor([&] { return peers.WhyGone("frontend").has_value(); }, 2s));
  EXPECT_THAT(*peers.WhyGone("frontend"), HasSubstr("out of film"));
}

TEST(CameraLink, ALateProcessGetsTheCamera) {
  Bus bus(Memory());
  const Camera camera = RandomMessages(1).Make<Camera>();
  CameraBeacon beacon(bus, camera);
  std::this_thread::sleep_for(50ms);
  const Peers peers(bus);
  CameraReceiver late(bus);
  const auto start = std::chrono::steady_clock::now();
  const auto received = late.Wait(peers);
  ASSERT_TRUE(received);
  EXPECT_EQ(received->fx, camera.fx);
  EXPECT_LT(std::chrono::steady_clock::now() - start, 500ms) << "asked, not waited for the beacon";
}

TEST(CameraLink, WaitingEndsWithAnInterrupt) {
  Bus bus(Memory());
  const Peers peers(bus);
  CameraReceiver receiver(bus);
  bus.Interrupt();
  EXPECT_FALSE(receiver.Wait(peers));
}

TEST(CameraLink, APlayerThatFailedIsNotWaitedFor) {
  Bus bus(Memory());
  const Peers peers(bus);
  CameraReceiver receiver(bus);
  StatusReporter player(bus, "player");
  std::thread failing([&] {
    std::this_thread::sleep_for(50ms);
    player.SetState(ProcessState::kFailed, "no such folder");
  });
  try {
    receiver.Wait(peers);
    ADD_FAILURE() << "there is no camera";
  } catch (const PeerGoneError& e) {
    EXPECT_THAT(e.what(), HasSubstr("no such folder"));
  }
  failing.join();
  player.SetState(ProcessState::kFinished);
  ASSERT_TRUE(
      bus.WaitFor([&] { return peers.Get("player")->state == ProcessState::kFinished; }, 2s));
  EXPECT_FALSE(receiver.Wait(peers)) << "it was stopped before it played";
}

TEST(Peers, AnInstanceAtWorkSpeaksForTheProcess) {
  Bus bus(Memory());
  Peers peers(bus);
  std::mutex mutex;
  std::vector<ProcessState> seen;
  peers.OnNewInstance([&](const ProcessStatus& status, int64_t) {
    const std::lock_guard lock(mutex);
    seen.push_back(status.state);
  });
  const auto say = [&](int64_t session, ProcessState state) {
    ProcessStatus status;
    status.process = "player";
    status.state = state;
    Header header;
    header.session = session;
    bus.Publish(kStatusChannel, Encode(header, status));
  };
  say(1, ProcessState::kRunning);
  say(2, ProcessState::kStarting);
  say(2, ProcessState::kFailed);
  ASSERT_TRUE(bus.WaitFor([&] { return bus.counters().received == 3; }, 2s));
  EXPECT_EQ(peers.Session("player"), 1);
  EXPECT_EQ(peers.Get("player")->state, ProcessState::kRunning);
  EXPECT_FALSE(peers.WhyGone("player"));
  say(1, ProcessState::kFinished);
  say(3, ProcessState::kStarting);
  ASSERT_TRUE(bus.WaitFor([&] { return bus.counters().received == 5; }, 2s));
  EXPECT_EQ(peers.Session("player"), 3);
  EXPECT_THAT(
      seen, ElementsAre(ProcessState::kRunning, ProcessState::kStarting, ProcessState::kStarting));
  EXPECT_THAT(peers.NeverHeard({"player", "backend"}), ElementsAre("backend"));
}

}  // namespace
}  // namespace vpslam::test
