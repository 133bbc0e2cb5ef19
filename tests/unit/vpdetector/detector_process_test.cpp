#include "vpdetector/detector_process.h"

#include <atomic>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>
#include <unistd.h>

#include "core/messages/command.h"
#include "core/transport/channels.h"
#include "core/transport/inbox.h"
#include "core/transport/stream_writer.h"
#include "frontend/line_source.h"

namespace vpslam {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

BusOptions Udp(double drop_share = 0, uint64_t seed = 1) {
  BusOptions options;
  options.url = fmt::format("udpm://239.255.76.67:{}", 20000 + getpid() % 20000);
  options.drop_share = drop_share;
  options.drop_seed = seed;
  return options;
}

Camera SmallCamera(int width = 160, int height = 120) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = width;
  camera.cx = 0.5 * width;
  camera.cy = 0.5 * height;
  return camera;
}

/// An instance as its process would run it.
class Instance {
 public:
  explicit Instance(double drop_share = 0)
      : bus_(Udp(drop_share, 3)),
        peers_(bus_),
        status_(bus_, DetectorProcess::kName),
        process_(bus_, peers_, status_, DetectorOptions()),
        thread_([this] {
          try {
            process_.Run();
          } catch (const std::exception& e) {
            error_ = e.what();
          }
          ended_ = true;
        }) {}
  ~Instance() { Stop(); }
  void Stop() {
    bus_.Interrupt();
    if (thread_.joinable()) thread_.join();
  }
  bool HasEnded(std::chrono::seconds timeout = 10s) {
    for (int i = 0; i < timeout / 10ms && !ended_; ++i) std::this_thread::sleep_for(10ms);
    return ended_;
  }
  int64_t session() const { return bus_.session(); }
  int64_t answered() const { return status_.Snapshot().processed; }
  int64_t rejected() { return bus_.counters().rejected; }
  const std::string& error() const { return error_; }

 private:
  Bus bus_;
  Peers peers_;
  StatusReporter status_;
  DetectorProcess process_;
  std::string error_;  ///< after the end
  std::atomic<bool> ended_{false};
  std::thread thread_;
};

/// The rest of the graph: sends images, asks, and listens.
class Rest {
 public:
  explicit Rest(const Camera& camera = SmallCamera(), double drop_share = 0)
      : bus_(Udp(drop_share, 5)),
        peers_(bus_),
        beacon_(bus_, camera),
        lines_(bus_, kLinesChannel, 1000),
        images_(bus_, kImageChannel, {}),
        requests_(bus_, kLinesRequestChannel),
        commands_(bus_, kCommandChannel) {}

  bool IsReady() {
    return bus_.WaitFor(
        [this] {
          const auto status = peers_.Get(DetectorProcess::kName);
          return status && status->state == ProcessState::kRunning;
        },
        10s);
  }
  void Send(int64_t seq, const cv::Mat& pixels) {
    ImageFrame image;
    image.frame_seq = seq;
    image.stamp_us = 1000 * seq;
    image.pixels = pixels;
    images_.Send(InlineImage(image));
  }
  void Ask(int64_t seq, int64_t detector) { requests_.Publish({seq, bus_.session(), detector}); }
  std::optional<LineSet> Answer(std::chrono::milliseconds timeout = 20s) {
    bus_.WaitFor([this] { return lines_.HasMessage(); }, timeout);
    auto message = lines_.TryTake();
    return message ? std::optional(message->value) : std::nullopt;
  }

  Bus bus_;
  Peers peers_;
  CameraBeacon beacon_;
  Inbox<LineSet> lines_;
  StreamWriter<ImageMessage> images_;
  Publisher<LinesRequest> requests_;
  Publisher<Command> commands_;
};

cv::Mat Picture(int seed = 1) {
  cv::Mat image(120, 160, CV_8UC1, cv::Scalar(60));
  cv::RNG random(seed);
  for (int i = 0; i < 6; ++i) {
    const cv::Point corner(random.uniform(0, 100), random.uniform(0, 70));
    cv::rectangle(image, cv::Rect(corner, cv::Size(55, 45)), cv::Scalar(random.uniform(0, 255)),
                  -1);
  }
  return image;
}

void ExpectSameLines(const LineSet& a, const LineSet& b) {
  ASSERT_EQ(a.lines.size(), b.lines.size());
  for (size_t i = 0; i < a.lines.size(); ++i) {
    EXPECT_EQ(a.lines[i].start_px, b.lines[i].start_px);
    EXPECT_EQ(a.lines[i].end_px, b.lines[i].end_px);
    EXPECT_EQ(a.lines[i].descriptor, b.lines[i].descriptor);
    EXPECT_EQ(a.lines[i].label, b.lines[i].label);
  }
  EXPECT_EQ(a.cam_from_manhattan.coeffs(), b.cam_from_manhattan.coeffs());
  EXPECT_EQ(a.covariance_rad2, b.covariance_rad2);
}

TEST(DetectorProcess, AnswersWhatItIsAskedOnceInTheOrderOfAsking) {
  Instance detector;
  Rest rest;
  ASSERT_TRUE(rest.IsReady());
  for (int seq = 0; seq < 5; ++seq) rest.Send(seq, Picture(seq));
  for (const int seq : {3, 0, 4}) rest.Ask(seq, detector.session());
  rest.Ask(2, detector.session() + 1);  // of somebody else
  for (const int seq : {3, 0, 4}) {
    const auto lines = rest.Answer();
    ASSERT_TRUE(lines);
    EXPECT_EQ(lines->frame_seq, seq);
    EXPECT_EQ(lines->stamp_us, 1000 * seq);
    EXPECT_FALSE(lines->lines.empty());
    EXPECT_GE(lines->lines_ms, 0);
    EXPECT_GE(lines->descriptors_ms, 0);
    EXPECT_GE(lines->vps_ms, 0);
    ExpectSameLines(*lines, Detector(SmallCamera(), DetectorOptions()).Detect(Picture(seq)));
  }
  EXPECT_FALSE(rest.Answer(300ms));
}

TEST(DetectorProcess, TheRequestMayComeBeforeTheImage) {
  Instance detector;
  Rest rest;
  ASSERT_TRUE(rest.IsReady());
  rest.Ask(0, detector.session());
  rest.Ask(0, detector.session());
  EXPECT_FALSE(rest.Answer(200ms));
  rest.Send(0, Picture());
  ASSERT_TRUE(rest.Answer());
  EXPECT_FALSE(rest.Answer(300ms)) << "once, though it was asked twice meanwhile";
}

TEST(DetectorProcess, SharedMemoryAndInlinePixelsGiveTheSame) {
  Instance detector;
  Rest rest;
  ASSERT_TRUE(rest.IsReady());
  ImagePool pool(ImageSegmentName(rest.bus_.session()), 2, 160 * 120);
  ImageFrame image;
  image.pixels = Picture();
  rest.images_.Send(pool.Store(image));
  rest.Send(1, image.pixels);
  rest.Ask(0, detector.session());
  rest.Ask(1, detector.session());
  const auto shared = rest.Answer(), inlined = rest.Answer();
  ASSERT_TRUE(shared && inlined);
  ExpectSameLines(*shared, *inlined);
}

TEST(DetectorProcess, AnImageThatDoesNotFitIsAnsweredWithoutLines) {
  Instance detector;
  Rest rest;
  ASSERT_TRUE(rest.IsReady());
  rest.Send(0, cv::Mat(50, 60, CV_8UC1, cv::Scalar(0)));
  rest.Ask(0, detector.session());
  const auto lines = rest.Answer();
  ASSERT_TRUE(lines);
  EXPECT_EQ(lines->frame_seq, 0);
  EXPECT_TRUE(lines->lines.empty());
}

TEST(DetectorProcess, AlienAndTruncatedMessagesAreCountedOnly) {
  Instance detector;
  Rest rest;
  ASSERT_TRUE(rest.IsReady());
  std::vector<uint8_t> good = Encode(Header(), Command{"vpdetector", CommandAction::kStop});
  good.resize(good.size() / 2);
  const std::vector<uint8_t> alien(200, 0xab);
  for (const char* channel : {kImageChannel, kLinesRequestChannel, kCommandChannel}) {
    rest.bus_.Publish(channel, good);
    rest.bus_.Publish(channel, alien);
  }
  rest.Send(0, Picture());
  rest.Ask(0, detector.session());
  EXPECT_TRUE(rest.Answer());
  EXPECT_EQ(detector.rejected(), 6);
}

TEST(DetectorProcess, StopsOnCommand) {
  Instance one;
  Rest rest;
  ASSERT_TRUE(rest.IsReady());
  rest.commands_.Publish({"player", CommandAction::kStop});
  rest.commands_.Publish({"", CommandAction::kStop});
  rest.Send(0, Picture());
  rest.Ask(0, one.session());
  ASSERT_TRUE(rest.Answer()) << "the player's business";
  rest.commands_.Publish({"vpdetector", CommandAction::kStop});
  EXPECT_TRUE(one.HasEnded());
  EXPECT_EQ(one.error(), "");
}

TEST(DetectorProcess, EndsWithTheSequence) {
  Instance one;
  Rest rest;
  ASSERT_TRUE(rest.IsReady());
  rest.Send(0, Picture());
  rest.Ask(0, one.session());
  ASSERT_TRUE(rest.Answer());
  rest.images_.SendEnd();
  EXPECT_TRUE(one.HasEnded());
  EXPECT_EQ(one.error(), "");
}

TEST(DetectorProcess, EndsWithThePlayerWhenTheEndOfTheStreamGotLost) {
  Instance one;
  Rest rest;
  ASSERT_TRUE(rest.IsReady());
  StatusReporter player(rest.bus_, "player");
  player.SetState(ProcessState::kFinished);
  EXPECT_TRUE(one.HasEnded());
  EXPECT_EQ(one.error(), "");
}

TEST(DetectorProcess, SharedMemoryOutOfReachIsAnErrorThatNamesTheRemedy) {
  Instance one;
  Rest rest;
  ASSERT_TRUE(rest.IsReady());
  for (int seq = 0; seq < 10; ++seq) {
    ImageMessage image;
    image.frame_seq = seq;
    image.width = 160;
    image.height = 120;
    image.segment = fmt::format("/vpslam-nowhere-{}", getpid());
    image.generation = 2;
    rest.images_.Send(image);
    rest.Ask(seq, one.session());
    std::this_thread::sleep_for(20ms);
  }
  EXPECT_TRUE(one.HasEnded());
  EXPECT_THAT(one.error(), HasSubstr("--inline"));
}

struct Awkward {
  std::string name;
  Camera camera;
  cv::Mat image;
};

std::vector<Awkward> AwkwardCases() {
  std::vector<Awkward> cases;
  const auto add = [&](const std::string& name, const cv::Mat& image) {
    cases.push_back({name, SmallCamera(image.cols, image.rows), image});
  };
  cv::Mat noise(480, 640, CV_8UC1);
  cv::RNG(4).fill(noise, cv::RNG::UNIFORM, 0, 256);
  add("black", cv::Mat(480, 640, CV_8UC1, cv::Scalar(0)));
  add("white", cv::Mat(480, 640, CV_8UC1, cv::Scalar(255)));
  add("tiny", noise(cv::Rect(0, 0, 16, 16)).clone());
  add("portrait", noise.t());
  add("noise", noise);
  cv::Mat huge(3000, 4000, CV_8UC1, cv::Scalar(30));
  for (int i = 0; i < 40; ++i) {
    cv::line(huge, {100 * i, 0}, {4000 - 50 * i, 3000}, cv::Scalar(220), 5, cv::LINE_AA);
  }
  add("huge", huge);
  cv::Mat picture;
  cv::resize(Picture(), picture, cv::Size(640, 480));
  for (int i = 0; i < 5; ++i) {
    Awkward absurd{fmt::format("absurd intrinsics {}", i), SmallCamera(640, 480), picture};
    Camera& c = absurd.camera;
    if (i == 0) c.fx = c.fy = 1e-3;
    if (i == 1) c.fx = 6e4, c.fy = 1;
    if (i == 2) c.k1 = -5, c.k3 = 100;
    if (i == 3) c.p1 = c.p2 = 3;
    if (i == 4) c.cx = -600, c.cy = 900;
    cases.push_back(absurd);
  }
  return cases;
}

TEST(DetectorProcess, AnswersAwkwardImages) {
  for (const Awkward& awkward : AwkwardCases()) {
    SCOPED_TRACE(awkward.name);
    ASSERT_FALSE(awkward.camera.Validate());
    Rest rest(awkward.camera);
    Instance detector;
    ASSERT_TRUE(rest.IsReady());
    // A huge image inline is more than a socket's buffer holds.
    ImagePool pool(ImageSegmentName(rest.bus_.session()), 1, awkward.image.total());
    ImageFrame image;
    image.pixels = awkward.image;
    rest.images_.Send(pool.Store(image));
    rest.Ask(0, detector.session());
    const auto lines = rest.Answer();
    ASSERT_TRUE(lines);
    EXPECT_EQ(lines->frame_seq, 0);
  }
}

/// Asks through the frontend's LineSource, as in lockstep. Returns the answers by frame.
std::map<int64_t, LineSet> PlayInLockstep(Rest& rest, LineSource& source, int first, int last,
                                          std::chrono::milliseconds pause = 0ms) {
  std::map<int64_t, LineSet> answers;
  for (int seq = first; seq < last; ++seq) {
    ImageFrame image;
    image.frame_seq = seq;
    image.stamp_us = 1000 * seq;
    image.pixels = Picture(seq);
    std::optional<LineSet> lines;
    std::thread waiting([&] { lines = source.WaitFor(image); });
    // The stream repeats an image until it was dealt with.
    std::atomic<bool> done = false;
    std::thread sending([&] {
      for (int i = 0; !done; ++i) {
        if (i % 10 == 0) {
          rest.Send(seq, image.pixels);
          source.AddImage(rest.bus_.session(), seq);
        }
        std::this_thread::sleep_for(10ms);
      }
    });
    waiting.join();
    done = true;
    sending.join();
    if (lines) answers.emplace(seq, *lines);
    std::this_thread::sleep_for(pause);
  }
  return answers;
}

TEST(SharedDetectors, TwoGiveWhatOneGives) {
  std::map<int64_t, LineSet> answers[2];
  for (const int instances : {1, 2}) {
    Rest rest;
    std::vector<std::unique_ptr<Instance>> detectors;
    for (int i = 0; i < instances; ++i) detectors.push_back(std::make_unique<Instance>());
    LineSource source(rest.bus_, rest.peers_, LineSourceOptions::ForPace(Pace::kLockstep));
    ASSERT_TRUE(rest.IsReady());
    answers[instances - 1] = PlayInLockstep(rest, source, 0, 12);
  }
  ASSERT_EQ(answers[0].size(), 12u);
  ASSERT_EQ(answers[1].size(), 12u);
  for (const auto& [seq, lines] : answers[0]) ExpectSameLines(lines, answers[1].at(seq));
}

TEST(SharedDetectors, OneThatDiesCostsNothingAndOneThatComesTakesItsShare) {
  Rest rest;
  LineSource source(rest.bus_, rest.peers_, LineSourceOptions::ForPace(Pace::kLockstep));
  auto first = std::make_unique<Instance>();
  ASSERT_TRUE(rest.IsReady());
  EXPECT_EQ(PlayInLockstep(rest, source, 0, 4).size(), 4u);
  Instance second;
  ASSERT_TRUE(rest.IsReady());
  for (int i = 0; i < 500 && second.answered() == 0; ++i) {
    const int seq = 4 + i;
    ASSERT_EQ(PlayInLockstep(rest, source, seq, seq + 1).size(), 1u);
    if (second.answered() > 0) first.reset();
    if (!first) {
      EXPECT_EQ(PlayInLockstep(rest, source, seq + 1, seq + 6).size(), 5u);
      break;
    }
  }
  EXPECT_FALSE(first) << "the second took no share";
}

TEST(SharedDetectors, LossesAreMadeGood) {
  Rest rest(SmallCamera(), 0.1);
  Instance one(0.1), two(0.1);
  LineSource source(rest.bus_, rest.peers_, LineSourceOptions::ForPace(Pace::kLockstep));
  ASSERT_TRUE(rest.IsReady());
  EXPECT_EQ(PlayInLockstep(rest, source, 0, 20).size(), 20u);
}

TEST(SharedDetectors, InRealtimeAnImageGoesOnWithoutLines) {
  Rest rest;
  LineSource source(rest.bus_, rest.peers_, LineSourceOptions::ForPace(Pace::kRealtime));
  ImageFrame image;
  image.published_us = 0;  // long ago
  image.pixels = Picture();
  EXPECT_FALSE(source.WaitFor(image));
}

}  // namespace
}  // namespace vpslam
