// Publishes what this process says of itself: at 1 Hz, and at once when its state changes.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>

#include "core/messages/process_status.h"
#include "core/transport/bus.h"
#include "core/transport/publisher.h"

namespace vpslam {

class StatusReporter {
 public:
  StatusReporter(Bus& bus, const std::string& process);
  /// Says the last word once more.
  ~StatusReporter();

  void SetState(ProcessState state, const std::string& message = "");
  /// Out of turn: somebody has come who does not know it yet.
  void PublishNow();
  void AddProcessed(int64_t count = 1);
  void SetQueued(int64_t count);
  /// `count` is asked whenever the status is told, instead, as long as the registration lives.
  [[nodiscard]] Bus::Registration WatchQueue(std::function<int64_t()> count);
  /// As it would be published now.
  ProcessStatus Snapshot() const;

 private:
  void Tick();
  void PublishLocked();
  ProcessStatus SnapshotLocked() const;

  Bus& bus_;
  mutable std::mutex mutex_;
  Publisher<ProcessStatus> publisher_;
  ProcessStatus status_;
  std::function<int64_t()> queued_;  ///< may be empty
  std::chrono::steady_clock::time_point last_published_;
  std::chrono::steady_clock::time_point last_rated_ = std::chrono::steady_clock::now();
  int64_t processed_at_last_ = 0;  // rating
  Bus::Registration timer_;
};

/// CPU time (user + system) of this process so far, and the most memory it ever had.
double ProcessCpuSeconds();
double ProcessPeakRssMb();

}  // namespace vpslam
