// The player's work in the graph: sends a source's frames, at the pace of the run.
//
// Lockstep: one frame on its way at a time. Lossless: a few, as fast as the consumers are done with
// them. Realtime: each when its time stamp says so, whoever follows.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/pace.h"
#include "core/transport/bus.h"
#include "core/transport/peers.h"
#include "core/transport/status_reporter.h"
#include "player/image_source.h"

namespace vpslam {

struct PlayOptions {
  Pace pace = Pace::kLockstep;
  /// Processes that have to be ready before the first frame; those of them that consume images are
  /// waited for, except in realtime.
  std::vector<std::string> required;
  bool inline_pixels = false;   ///< in the message itself instead of shared memory
  std::string record = "none";  ///< ProcessOptions::record
  /// Called with time and true world_from_cam of each frame that is sent, where the source knows
  /// it.
  std::function<void(int64_t, const SE3&)> on_truth = [](int64_t, const SE3&) {};
};

/// Sends CAMERA, TRUTH and IMAGE (or FEATURES, from a log) until the source ends, or `stop` is set,
/// or COMMAND kStop comes; then the end-of-stream marker. Commands pause it, let it step, and limit
/// its rate. Returns the number of frames sent. A source that breaks down still ends the stream,
/// then its error is thrown on. Throws PeerGoneError if a required process is gone.
int64_t Play(Bus& bus, Peers& peers, StatusReporter& status, ImageSource& source,
             const PlayOptions& options, const std::atomic<bool>& stop);

}  // namespace vpslam
