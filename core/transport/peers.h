// What the other processes say of themselves on STATUS. Several instances of one process may run at
// a time (detectors), or one after the other; their sessions tell them apart.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/messages/process_status.h"
#include "core/transport/bus.h"
#include "core/transport/codec.h"

namespace vpslam {

class Peers {
 public:
  using Clock = std::chrono::steady_clock;
  /// A process that spoke and then says nothing for so long is gone.
  static constexpr std::chrono::seconds kSilence{30};

  explicit Peers(Bus& bus, std::chrono::milliseconds silence = kSilence);

  /// The last status of `process`; nullopt if it was never heard.
  std::optional<ProcessStatus> Get(const std::string& process) const;
  /// Of the process that says so last; another number means that it was restarted.
  std::optional<int64_t> Session(const std::string& process) const;
  /// Those of `processes` of which no instance says that it may be sent to.
  std::vector<std::string> NotReady(const std::vector<std::string>& processes) const;
  /// Sleeps until all are ready; false if interrupted or after `timeout`.
  bool WaitReady(const std::vector<std::string>& processes, std::chrono::milliseconds timeout);
  /// One line why `process` will not answer any more (it failed, or fell silent); nullopt while
  /// there is hope, also if it was never heard. Where it has several instances: why the last of
  /// them will not.
  std::optional<std::string> WhyGone(const std::string& process) const;
  /// Bus::WaitFor without a time limit, but throws PeerGoneError once one of `processes` is gone.
  /// False if interrupted.
  bool WaitFor(const std::function<bool()>& predicate, const std::vector<std::string>& processes);

 private:
  struct Instance {
    ProcessStatus status;
    int64_t session = 0;
    Clock::time_point heard;
  };
  static constexpr std::size_t kMaxInstances = 64;  ///< the longest silent one is forgotten first

  void Receive(std::span<const uint8_t> bytes);
  std::optional<std::string> WhyGone(const std::string& process, const Instance& instance) const;

  Bus& bus_;
  const std::chrono::milliseconds silence_;
  mutable std::mutex mutex_;
  std::map<std::string, std::deque<Instance>> peers_;  ///< per name, the last heard one last
  Bus::Registration registration_;
};

}  // namespace vpslam
