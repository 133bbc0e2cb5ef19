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

  /// Called once for each instance of a process that is heard, this one included, with its first
  /// status and its session. Runs on the receive thread, where what it throws reaches
  /// Bus::WaitFor; for those that were heard before, at once.
  using OnNew = std::function<void(const ProcessStatus&, int64_t)>;
  void OnNewInstance(OnNew on_new);

  /// The last status of `process`; nullopt if it was never heard. Of several instances: of the one
  /// that spoke last among those at work, else among those that start, else of all.
  std::optional<ProcessStatus> Get(const std::string& process) const;
  /// Of the same instance; another number than before means that it was restarted.
  std::optional<int64_t> Session(const std::string& process) const;
  /// Those of `processes` of which no instance says that it may be sent to.
  std::vector<std::string> NotReady(const std::vector<std::string>& processes) const;
  /// Sleeps until all are ready; false if interrupted or after `timeout`.
  bool WaitReady(const std::vector<std::string>& processes, std::chrono::milliseconds timeout);
  /// One line why `process` will not answer any more (it failed, or fell silent); nullopt while
  /// there is hope, also if it was never heard. Where it has several instances: why the last of
  /// them will not.
  std::optional<std::string> WhyGone(const std::string& process) const;
  /// Those of `processes` of which nothing was ever heard.
  std::vector<std::string> NeverHeard(const std::vector<std::string>& processes) const;
  /// Bus::WaitFor without a time limit, but throws PeerGoneError once one of `processes` is gone,
  /// or was never heard before the player was gone. Tells in the log if one of them is not heard.
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
  const Instance* FindLocked(const std::string& process) const;
  std::optional<std::string> WhyGone(const std::string& process, const Instance& instance) const;
  std::optional<std::string> WhyGoneOrNeverComing(const std::string& process) const;

  Bus& bus_;
  const std::chrono::milliseconds silence_;
  mutable std::mutex mutex_;
  std::map<std::string, std::deque<Instance>> peers_;  ///< per name, the last heard one last
  OnNew on_new_;
  Bus::Registration registration_;
};

/// For a wait that may be in vain: names in the log the processes of which nothing was heard, after
/// 5 s and then ever more rarely.
class UnheardNotice {
 public:
  /// To be called now and then while waiting.
  void Look(const Bus& bus, const Peers& peers, const std::vector<std::string>& processes);

 private:
  const Peers::Clock::time_point start_ = Peers::Clock::now();
  std::chrono::seconds next_{5};
};

}  // namespace vpslam
