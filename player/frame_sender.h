// Sends a source's frames to who tracks them: as images, or as the features that a log holds.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>

#include "core/base/pace.h"
#include "core/transport/bus.h"
#include "core/transport/stream_writer.h"
#include "player/image_source.h"
#include "player/play.h"

namespace vpslam {

class FrameSender {
 public:
  virtual ~FrameSender() = default;

  /// Blocks while the stream's window is full, except in realtime; false if interrupted. Throws
  /// PeerGoneError.
  virtual bool Send(const SourceFrame& frame, int64_t frame_seq) = 0;
  /// Whether Send would go through at once. Throws PeerGoneError.
  virtual bool HasRoom() const = 0;
  /// Nothing may follow.
  virtual bool SendEnd() = 0;
  /// Those who need the frames are done with them; false after `timeout` or if interrupted.
  virtual bool WaitAllAcked(std::chrono::milliseconds timeout) = 0;
};

/// How many frames may be on their way at this pace, and what happens with more of them.
StreamWriterOptions FrameWindow(Pace pace);

/// Of what the source delivers.
std::unique_ptr<FrameSender> MakeFrameSender(Bus& bus, const ImageSource& source,
                                             const PlayOptions& options);

}  // namespace vpslam
