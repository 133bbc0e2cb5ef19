// Paces at which the backend works beside the tracker.
#include <algorithm>

#include <gtest/gtest.h>

#include "graph.h"

namespace vpslam::test {
namespace {

std::vector<int> TrackedImages(const std::vector<std::string>& log) {
  std::vector<int> images;
  for (const std::string& line : log) {
    if (line.starts_with("image ")) images.push_back(std::stoi(line.substr(6)));
  }
  return images;
}

int KeyframesAt(const std::vector<std::string>& log, int image) {
  const std::string begin = fmt::format("image {} {} with ", image, image);
  for (const std::string& line : log) {
    if (line.starts_with(begin)) return std::stoi(line.substr(begin.size()));
  }
  return -1;
}

/// Parts of an answer follow each other, without an image in between.
bool AnswersAreWhole(const std::vector<std::string>& log) {
  int parts = 0;
  for (const std::string& line : log) {
    if (line.starts_with("delta ")) ++parts;
    if (line.starts_with("image ") && parts % FakeMapper::kParts != 0) return false;
  }
  return true;
}

TEST(Lossless, EveryImageIsTrackedWhileTheBackendWorks) {
  Graph graph(0, 1, Pace::kLossless);
  graph.mapper_.work_ = 60ms;
  graph.tracker_.work_ = 5ms;
  graph.StartBackend();
  graph.StartFrontend();
  graph.Play();
  EXPECT_EQ(graph.error_, "");
  const auto& log = graph.tracker_.log_;
  const std::vector<int> images = TrackedImages(log);
  ASSERT_EQ(images.size(), static_cast<std::size_t>(kFrames));
  EXPECT_TRUE(std::is_sorted(images.begin(), images.end()));
  EXPECT_TRUE(AnswersAreWhole(log));
  // Image 4 starts the map, and waits for it; image 9 becomes a keyframe, and 10 does not wait.
  EXPECT_EQ(KeyframesAt(log, 5), 2);
  EXPECT_EQ(KeyframesAt(log, 10), 2);
  // Image 14 proposes the next one, so the one before it has to be answered before 15.
  EXPECT_GE(KeyframesAt(log, 15), 3);
  EXPECT_LE(*std::max_element(graph.tracker_.unanswered_.begin(), graph.tracker_.unanswered_.end()),
            1);
  EXPECT_EQ(graph.mapper_.keyframes_.size(), static_cast<std::size_t>(kKeyframes));
  EXPECT_FALSE(graph.mapper_.asked_) << "the map does not depend on time";
  EXPECT_EQ(graph.tracker_.version_, graph.mapper_.version_) << "answers are awaited in the end";
  EXPECT_EQ(graph.RecordedPoses().size(), static_cast<std::size_t>(kFrames + 1));
}

class LossyLossless : public ::testing::TestWithParam<int> {};

TEST_P(LossyLossless, LossesCostNoImageAndNoKeyframe) {
  Graph graph(0.05, GetParam(), Pace::kLossless);
  graph.mapper_.work_ = 10ms;
  graph.StartFrontend();
  graph.StartBackend();
  graph.Play();
  EXPECT_EQ(graph.error_, "");
  EXPECT_GT(graph.bus_.counters().lost_on_purpose, 0);
  EXPECT_EQ(TrackedImages(graph.tracker_.log_).size(), static_cast<std::size_t>(kFrames));
  EXPECT_EQ(graph.mapper_.keyframes_.size(), static_cast<std::size_t>(kKeyframes));
  EXPECT_EQ(graph.RecordedPoses().size(), static_cast<std::size_t>(kFrames + 1));
}
INSTANTIATE_TEST_SUITE_P(Seeds, LossyLossless, ::testing::Values(1, 2, 3));

TEST(Realtime, ImagesDoNotWaitForABusyBackend) {
  Graph graph(0, 1, Pace::kRealtime);
  graph.mapper_.work_ = 150ms;
  graph.StartBackend();
  graph.StartFrontend();
  graph.Play(40ms);
  EXPECT_EQ(graph.error_, "");
  const auto& log = graph.tracker_.log_;
  EXPECT_TRUE(AnswersAreWhole(log));
  const auto& unanswered = graph.tracker_.unanswered_;
  EXPECT_GT(std::count_if(unanswered.begin(), unanswered.end(), [](int n) { return n > 0; }), 1)
      << "images were tracked while a keyframe was under work";
  EXPECT_EQ(graph.tracker_.version_, graph.mapper_.version_) << "answers are awaited in the end";
  EXPECT_GT(graph.mapper_.urgent_, 0) << "the backend knows that more keyframes wait";
  // The start of the map alone holds images up: two keyframes of 0.15 s each.
  EXPECT_GE(TrackedImages(log).size(), static_cast<std::size_t>(kFrames / 2));
}

TEST(Realtime, ASlowTrackerMissesImagesAndSaysSo) {
  Graph graph(0, 1, Pace::kRealtime);
  graph.tracker_.work_ = 60ms;
  graph.StartBackend();
  graph.StartFrontend();
  graph.Play(10ms);
  EXPECT_EQ(graph.error_, "");
  const std::vector<int> images = TrackedImages(graph.tracker_.log_);
  EXPECT_LT(images.size(), 15u);
  EXPECT_GE(images.size(), 4u);
  EXPECT_TRUE(std::is_sorted(images.begin(), images.end()));
  EXPECT_EQ(images.back(), kFrames - 1) << "the newest is never dropped";
  const auto& counters = graph.bus_.counters();
  EXPECT_EQ(counters.dropped + static_cast<int64_t>(images.size()), kFrames);
  EXPECT_EQ(counters.rejected, 0) << "no slot was written while it was read";
}

TEST(Realtime, TheMapIsMadeUpForAfterALoss) {
  Graph graph(0, 1, Pace::kRealtime);
  graph.tracker_.refuse_version_ = 7;  // the first part of the third keyframe's answer
  graph.StartBackend();
  graph.StartFrontend();
  graph.Play(30ms);
  EXPECT_EQ(graph.error_, "");
  EXPECT_GE(graph.mapper_.snapshots_, 1);
  EXPECT_EQ(graph.tracker_.version_, graph.mapper_.version_);
  EXPECT_EQ(graph.tracker_.replica_.size(), static_cast<std::size_t>(kKeyframes));
}

}  // namespace
}  // namespace vpslam::test
