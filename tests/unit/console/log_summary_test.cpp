#include "console/log_summary.h"

#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/geometry/camera.h"
#include "core/messages/run_description.h"
#include "core/messages/truth.h"
#include "core/transport/channels.h"
#include "core/transport/codec.h"
#include "core/transport/event_log.h"

namespace vpslam {
namespace {

template <class T>
std::vector<uint8_t> Message(const T& value, int64_t session, int64_t seq, bool last = false) {
  Header header;
  header.session = session;
  header.seq = header.oldest_seq = seq;
  header.last = last;
  return Encode(header, value);
}

TEST(LogSummary, CountsWhatIsMissing) {
  const auto path =
      std::filesystem::temp_directory_path() / fmt::format("vpslam_summary_{}.lcm", getpid());
  {
    EventLogWriter log(path.string());
    Camera camera;
    camera.width = 64;
    camera.height = 48;
    camera.fx = camera.fy = 50;
    log.Write(1'000'000, kCameraChannel, Message(camera, 1, 0));
    log.Write(1'000'000, kRunChannel,
              Message(RunDescription{7, "abc", "{\"preset\": \"points\"}"}, 2, 0));
    // Two senders: of the first 1 and 3 are missing, 4 comes twice; nothing of the second.
    for (const int seq : {0, 2, 4, 4}) {
      log.Write(2'000'000, kTruthChannel, Message(Truth(), 10, seq));
    }
    for (const int seq : {0, 1}) log.Write(3'000'000, kTruthChannel, Message(Truth(), 11, seq));
    log.Write(3'500'000, kTruthChannel, Message(Truth(), 11, 2, true));
  }
  const auto summary = SummarizeLog(path.string());
  std::filesystem::remove(path);
  EXPECT_EQ(summary["events"], 9);
  EXPECT_EQ(summary["duration_s"], 2.5);
  EXPECT_EQ(summary["run"]["seed"], 7);
  EXPECT_EQ(summary["run"]["options"]["preset"], "points");
  EXPECT_EQ(summary["camera"]["width"], 64);
  const auto& truth = summary["channels"][kTruthChannel];
  EXPECT_EQ(truth["messages"], 7);
  EXPECT_EQ(truth["missing"], 2);
  EXPECT_EQ(truth["repeated"], 1);
  EXPECT_EQ(truth["ended"], 1);
}

}  // namespace
}  // namespace vpslam
