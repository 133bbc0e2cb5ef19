// Writes a log with messages of every type, all members at random:  write_random_log FILE COUNT
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "core/messages/command.h"
#include "core/messages/lines_request.h"
#include "core/messages/map_request.h"
#include "core/messages/outcome.h"
#include "core/messages/process_status.h"
#include "core/messages/run_description.h"
#include "core/messages/truth.h"
#include "core/transport/channels.h"
#include "core/transport/event_log.h"
#include "tests/unit/core/transport/random_messages.h"

namespace {

using namespace vpslam;

class Writer {
 public:
  explicit Writer(const std::string& path) : file_(path) {}

  template <class T>
  void Write(const std::string& channel) {
    const Header header = random_.Make<Header>();
    file_.Write(++stamp_us_, channel, Encode(header, random_.Make<T>()));
  }

 private:
  EventLogWriter file_;
  test::RandomMessages random_{1};
  int64_t stamp_us_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  try {
    Writer writer(argv[1]);
    for (int i = 0; i < std::atoi(argv[2]); ++i) {
      writer.Write<Camera>(kCameraChannel);
      writer.Write<ImageMessage>(kImageChannel);
      writer.Write<FrameFeatures>(kFeaturesChannel);
      writer.Write<LineSet>(kLinesChannel);
      writer.Write<LinesRequest>(kLinesRequestChannel);
      writer.Write<FramePose>(kPoseChannel);
      writer.Write<Truth>(kTruthChannel);
      writer.Write<KeyframeProposal>(kKeyframeChannel);
      writer.Write<MapDelta>(kMapChannel);
      writer.Write<MapRequest>(kMapRequestChannel);
      writer.Write<Ack>(kAckChannel);
      writer.Write<Command>(kCommandChannel);
      writer.Write<RunDescription>(kRunChannel);
      writer.Write<ProcessStatus>(kStatusChannel);
      writer.Write<Preview>(kPreviewChannel);
      writer.Write<Outcome>(kOutcomeChannel);
    }
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "write_random_log: %s\n", e.what());
    return 1;
  }
}
