// The recorder's work in the graph: follows poses, map and statuses, and writes the results.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/transport/bus.h"
#include "core/transport/status_reporter.h"
#include "recorder/message_log.h"
#include "recorder/results_folder.h"
#include "recorder/summary.h"

namespace vpslam {

/// Subscribed from its construction on.
class Recorder {
 public:
  /// `progress` is called with a line of JSON, at most every 0.2 s and at the end; may be empty.
  /// `log`: what to log besides. Throws std::runtime_error if its file cannot be made.
  Recorder(Bus& bus, StatusReporter& status, const ResultsFolder& folder, const RunInfo& info,
           std::function<void(const std::string&)> progress,
           const std::optional<MessageLogOptions>& log = std::nullopt);
  ~Recorder();

  /// Returns after the results were written: when poses and map have ended (true), or a while after
  /// `stop` was set, COMMAND kStop came for the recorder, or all who send poses and map were gone
  /// (false). COMMAND kSaveNow writes, too.
  /// Throws std::runtime_error with one line if the results cannot be written, or, after they were,
  /// if the log could not be.
  bool Run(const std::atomic<bool>& stop);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vpslam
