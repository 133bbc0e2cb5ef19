// The order of events in a graph, and how it ends.
#include "graph.h"

#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace vpslam::test {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> RightLog() {
  std::vector<std::string> log;
  int keyframes = 0, version = 0;
  for (int i = 0; i < kFrames; ++i) {
    log.push_back(fmt::format("image {} {} with {} keyframes", i, i, keyframes));
    log.push_back("late");
    if (i % 5 != 4) continue;
    const int more = keyframes == 0 ? 2 : 1;
    keyframes += more;
    for (int j = 0; j < more * FakeMapper::kParts; ++j) {
      log.push_back(fmt::format("delta {}", ++version));
    }
  }
  return log;
}

TEST(Graph, RunsASequenceInLockstepAndEnds) {
  Graph graph;
  graph.StartBackend();
  graph.StartFrontend();
  graph.Play();
  EXPECT_EQ(graph.error_, "");
  EXPECT_EQ(graph.tracker_.log_, RightLog());
  EXPECT_EQ(graph.mapper_.keyframes_.size(), static_cast<std::size_t>(kKeyframes));
  EXPECT_EQ(graph.mapper_.snapshots_, 0);

  const std::vector<FramePose> poses = graph.RecordedPoses();
  ASSERT_EQ(poses.size(), static_cast<std::size_t>(kFrames + 1));
  for (int i = 0; i < kFrames; ++i) {
    EXPECT_EQ(poses[i].frame_seq, i);
    EXPECT_EQ(poses[i].times.decode_ms, 0.5);
    EXPECT_GE(poses[i].times.transport_ms, 0);
    EXPECT_GE(poses[i].times.total_ms, poses[i].times.transport_ms);
    EXPECT_GT(poses[i].image_published_us, 0);
  }
  EXPECT_FALSE(poses.back().live) << "what Finish owed";
  EXPECT_TRUE(graph.poses_.Ended());
  std::size_t deltas = 0;
  while (graph.map_.TryTake()) ++deltas;
  EXPECT_EQ(deltas, static_cast<std::size_t>(kKeyframes * FakeMapper::kParts));
  EXPECT_TRUE(graph.map_.Ended());
}

TEST(Graph, EarlierFramesAreTrackedWhenTheLivePoseIsPublished) {
  Graph graph;
  std::size_t images = 0;
  graph.tracker_.on_late_ = [&] {
    ++images;
    // The recorder has it, while this call keeps the frontend from doing anything else.
    EXPECT_TRUE(graph.bus_.WaitFor([&] { return graph.poses_.size() >= images; }, 5s)) << images;
  };
  graph.StartBackend();
  graph.StartFrontend();
  graph.Play();
  EXPECT_EQ(graph.error_, "");
  EXPECT_EQ(images, static_cast<std::size_t>(kFrames));
}

class LossyGraph : public ::testing::TestWithParam<int> {};

TEST_P(LossyGraph, TheOrderOfEventsDoesNotDependOnLossOrLoad) {
  Graph graph(0.05, GetParam());
  graph.mapper_.work_ = std::chrono::milliseconds(GetParam() * 10);
  graph.StartFrontend();
  graph.StartBackend();
  graph.Play();
  EXPECT_EQ(graph.error_, "");
  EXPECT_GT(graph.bus_.counters().lost_on_purpose, 0);
  EXPECT_EQ(graph.tracker_.log_, RightLog());
  EXPECT_EQ(graph.RecordedPoses().size(), static_cast<std::size_t>(kFrames + 1));
}
INSTANTIATE_TEST_SUITE_P(Seeds, LossyGraph, ::testing::Values(1, 2, 3));

TEST(Graph, AReplicaThatMissedADeltaGetsASnapshotBeforeTheNextImage) {
  for (const int refused : {1, 5, 6, 9}) {  // first, middle and last part of an answer
    Graph graph;
    graph.tracker_.refuse_version_ = refused;
    graph.StartBackend();
    graph.StartFrontend();
    graph.Play();
    EXPECT_EQ(graph.error_, "");
    EXPECT_GE(graph.mapper_.snapshots_, 1) << refused;
    // What the tracker knew at each image is the same as if nothing had been missed.
    std::vector<std::string> images, right;
    for (const auto& line : graph.tracker_.log_) {
      if (line.rfind("image", 0) == 0) images.push_back(line);
    }
    for (const auto& line : RightLog()) {
      if (line.rfind("image", 0) == 0) right.push_back(line);
    }
    EXPECT_EQ(images, right) << refused;
    EXPECT_EQ(graph.tracker_.version_, graph.mapper_.version_) << refused;
  }
}

TEST(Graph, AFrontendThatStartsLateTakesTheMapOver) {
  Graph graph;
  for (int i = 0; i < 4; ++i) {
    KeyframeProposal keyframe;
    keyframe.id = KeyframeId(i);
    graph.mapper_.Process(keyframe);
  }
  graph.tracker_.next_id_ = 4;
  graph.StartBackend();
  graph.StartFrontend();
  CameraBeacon camera(graph.bus_, SmallCamera());
  ASSERT_TRUE(graph.bus_.WaitFor([&] { return graph.mapper_.snapshots_ > 0; }, 5s));
  ASSERT_TRUE(graph.peers_.WaitReady({"frontend"}, 5s));
  StreamWriter<ImageMessage> images(graph.bus_, kImageChannel, {"frontend"});
  ImageFrame frame;
  frame.pixels = cv::Mat(24, 32, CV_8UC1, cv::Scalar(0));
  ASSERT_TRUE(images.Send(InlineImage(frame)));
  ASSERT_TRUE(images.SendEnd());
  ASSERT_TRUE(images.WaitAllAcked(5s));
  ASSERT_TRUE(graph.bus_.WaitFor([&] { return graph.frontend_done_.load(); }, 5s));
  EXPECT_EQ(graph.error_, "");
  ASSERT_GE(graph.tracker_.log_.size(), 2u);
  EXPECT_EQ(*(graph.tracker_.log_.end() - 2), "image 0 0 with 4 keyframes");
}

TEST(Graph, AnImageThatCannotBeFetchedIsCountedAndPassedOver) {
  Graph graph;
  graph.StartBackend();
  graph.StartFrontend();
  ASSERT_TRUE(graph.peers_.WaitReady({"frontend", "backend"}, 5s));
  CameraBeacon camera(graph.bus_, SmallCamera());
  StreamWriter<ImageMessage> images(graph.bus_, kImageChannel, {"frontend"});
  ImageMessage nowhere;
  nowhere.width = 32;
  nowhere.height = 24;
  nowhere.segment = fmt::format("/vpslam-nowhere-{}", getpid());
  nowhere.generation = 2;
  ASSERT_TRUE(images.Send(nowhere));
  ASSERT_TRUE(images.SendEnd());
  ASSERT_TRUE(images.WaitAllAcked(5s));
  ASSERT_TRUE(graph.bus_.WaitFor([&] { return graph.frontend_done_ && graph.backend_done_; }, 5s));
  EXPECT_EQ(graph.error_, "");
  EXPECT_TRUE(graph.tracker_.log_.empty());
  EXPECT_EQ(graph.bus_.counters().rejected, 1);
}

TEST(Graph, AnInterruptEndsAllLoops) {
  Graph graph;
  graph.StartBackend();
  graph.StartFrontend();
  ASSERT_TRUE(graph.peers_.WaitReady({"frontend", "backend"}, 5s));
  CameraBeacon camera(graph.bus_, SmallCamera());
  std::this_thread::sleep_for(50ms);
  graph.bus_.Interrupt();
  for (int i = 0; i < 200 && !(graph.frontend_done_ && graph.backend_done_); ++i) {
    std::this_thread::sleep_for(10ms);
  }
  EXPECT_TRUE(graph.frontend_done_ && graph.backend_done_);
  EXPECT_EQ(graph.error_, "");
}

TEST(Graph, AFailedBackendEndsTheFrontendWithAnError) {
  Graph graph;
  StatusReporter backend(graph.bus_, "backend");
  backend.SetState(ProcessState::kReady);
  StreamReader<KeyframeProposal> keyframes(graph.bus_, kKeyframeChannel, "backend",
                                           AckPolicy::kOnReceipt);
  graph.StartFrontend();
  ASSERT_TRUE(graph.peers_.WaitReady({"frontend", "backend"}, 5s));
  CameraBeacon camera(graph.bus_, SmallCamera());
  StreamWriter<ImageMessage> images(graph.bus_, kImageChannel, {"frontend"});
  for (int i = 0; i < 5; ++i) {
    ImageFrame frame;
    frame.frame_seq = i;
    frame.pixels = cv::Mat(24, 32, CV_8UC1, cv::Scalar(i));
    ASSERT_TRUE(images.Send(InlineImage(frame)));
  }
  ASSERT_TRUE(graph.bus_.WaitFor([&] { return keyframes.size() == 2; }, 5s));
  backend.SetState(ProcessState::kFailed, "no more memory");
  ASSERT_TRUE(graph.bus_.WaitFor([&] { return graph.frontend_done_.load(); }, 5s));
  EXPECT_THAT(graph.error_, HasSubstr("no more memory"));
}

TEST(Graph, ABackendThatFailedAtTheStartIsNotWaitedFor) {
  Graph graph;
  StatusReporter backend(graph.bus_, "backend");
  graph.StartFrontend();
  CameraBeacon camera(graph.bus_, SmallCamera());
  std::this_thread::sleep_for(100ms);  // it waits for a backend that may be sent to
  EXPECT_FALSE(graph.frontend_done_);
  backend.SetState(ProcessState::kFailed, "no such settings");
  ASSERT_TRUE(graph.bus_.WaitFor([&] { return graph.frontend_done_.load(); }, 5s));
  EXPECT_THAT(graph.error_, HasSubstr("no such settings"));
}

TEST(Graph, APlayerThatFailedAtTheStartEndsAll) {
  Graph graph;
  graph.StartBackend();
  graph.StartFrontend();
  ASSERT_TRUE(graph.peers_.WaitReady({"frontend", "backend"}, 5s));
  graph.player_status_.SetState(ProcessState::kFailed, "no such folder");
  ASSERT_TRUE(graph.bus_.WaitFor([&] { return graph.frontend_done_ && graph.backend_done_; }, 5s));
  EXPECT_THAT(graph.error_, HasSubstr("no such folder"));
}

}  // namespace
}  // namespace vpslam::test
