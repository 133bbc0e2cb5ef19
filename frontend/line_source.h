// The lines of each image, from whatever detectors there are: asks for them as soon as it is told
// of an image (LineDispatch says whom), and joins them with it (LineJoiner).
#pragma once

#include <chrono>
#include <mutex>
#include <optional>
#include <span>

#include "core/base/pace.h"
#include "core/features/line_set.h"
#include "core/messages/image_frame.h"
#include "core/messages/lines_request.h"
#include "core/transport/bus.h"
#include "core/transport/peers.h"
#include "core/transport/publisher.h"
#include "frontend/line_dispatch.h"
#include "frontend/line_joiner.h"

namespace vpslam {

struct LineSourceOptions {
  LineDispatchOptions dispatch;
  LineJoinerOptions joiner;

  /// What suits a pace: kRealtime goes on without lines that come late, others wait for them.
  static LineSourceOptions ForPace(Pace pace);
};

/// Subscribed to what detectors say from its construction on.
class LineSource {
 public:
  static constexpr const char* kDetector = "vpdetector";

  LineSource(Bus& bus, Peers& peers, const LineSourceOptions& options);

  /// An image came, of this session of its sender: asks for its lines. To be called as soon as
  /// possible, from any thread. An image that is told again makes no difference.
  void AddImage(int64_t session, int64_t frame_seq);

  /// Sleeps until the lines of the image are there, or the joiner says to go on without them
  /// (nullopt), or the bus is interrupted (nullopt). Images are to come in order; one that is left
  /// out needs its lines no more. Throws PeerGoneError if all detectors are gone and it has to
  /// wait.
  std::optional<LineSet> WaitFor(const ImageFrame& image);
  /// The images begin anew: their sender was restarted.
  void Restart();

 private:
  using Clock = std::chrono::steady_clock;

  void OnStatus(std::span<const uint8_t> bytes);
  void OnLines(std::span<const uint8_t> bytes);
  void AskLocked();
  LineJoiner::Verdict Look(const ImageFrame& image);

  Bus& bus_;
  Peers& peers_;
  const LineJoinerOptions options_;
  std::mutex mutex_;  ///< of the next two
  LineDispatch dispatch_;
  LineJoiner joiner_;
  Publisher<LinesRequest> requests_;
  Bus::Registration statuses_, lines_, timer_;  // last: they end before what they use
};

}  // namespace vpslam
