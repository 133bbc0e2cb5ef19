// The log of a run: every message of its graph, in the format of lcm-logger.
//
// What it takes from reliable streams is complete, since their writers wait for the recorder:
// features and images until they are in the file (so a slow disk slows the run down, and nothing
// piles up), the others until they have come. In real time nobody waits, and a disk that is too
// slow misses messages. What is sent best effort is logged as it comes, and what did not come shows
// in the sequence numbers. The file begins with the camera and the run.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "core/messages/frame_pose.h"
#include "core/messages/map_delta.h"
#include "core/messages/run_description.h"
#include "core/transport/bus.h"
#include "core/transport/stream_reader.h"

namespace vpslam {

struct MessageLogOptions {
  std::string path;
  bool pixels = false;  ///< images, too, with their pixels inline
  RunDescription run;
  /// Of what waits to be written. Writers that wait for the recorder stay far below; in real time
  /// what comes beyond is left out.
  std::size_t max_waiting_bytes = 256 << 20;
};

class MessageLog {
 public:
  struct Count {
    int64_t messages = 0;
    int64_t bytes = 0;
    int64_t gaps = 0;  ///< sequence numbers that never came
  };

  /// Subscribes. Throws std::runtime_error with one line if the file cannot be made.
  MessageLog(Bus& bus, const MessageLogOptions& options);
  ~MessageLog();

  /// For the readers that the recorder has of POSE and MAP: a stream has one reader a process.
  StreamReader<FramePose>::Tap PoseTap();
  StreamReader<MapDelta>::Tap MapTap();

  /// The streams that only the log reads have ended.
  bool StreamsEnded() const;
  /// Writes what has come so far, and nothing more.
  void Close();
  /// What keeps it from being complete (the disk is full), one line; the run goes on without.
  std::optional<std::string> error() const;
  /// Messages that came, but are not in the file: the disk was too slow for a run in real time.
  int64_t left_out() const;
  /// By channel.
  std::map<std::string, Count> counts() const;
  const std::string& path() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vpslam
