// What each process says of itself, at 1 Hz and on change.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/description.h"

namespace vpslam {

/// Changes with every incompatible change of a message or of the flow.
inline constexpr int32_t kProtocolVersion = 4;

enum class ProcessState : int32_t {
  kStarting = 0,
  kReady = 1,  ///< subscribed; may be sent to
  kRunning = 2,
  kFinished = 3,  ///< its stream has ended and all of it was acknowledged
  kFailed = 4,    ///< `message` says why
};

struct ProcessStatus {
  static constexpr std::size_t kMaxMessageLength = 1024;

  std::string process;  ///< player, frontend, ...
  int32_t pid = 0;
  int32_t protocol_version = kProtocolVersion;
  ProcessState state = ProcessState::kStarting;
  double rate_hz = 0;  ///< messages worked on per second, over the last second
  int64_t processed = 0;
  int64_t queued = 0;    ///< waiting now
  int64_t dropped = 0;   ///< thrown away on purpose, queue full
  int64_t gaps = 0;      ///< sequence numbers that never came
  int64_t rejected = 0;  ///< malformed or alien messages
  int64_t resent = 0;
  double cpu_s = 0;  ///< user + system, since start
  double rss_peak_mb = 0;
  std::string message;  ///< for people; at most kMaxMessageLength, may be empty

  static constexpr const char* kWireName = "status_t";
  static void Describe(auto& v, auto& m) {
    auto& [process, pid, protocol_version, state, rate_hz, processed, queued, dropped, gaps,
           rejected, resent, cpu_s, rss_peak_mb, message] = m;
    using enum ProcessState;
    v("process", process, ProcessName());
    v("pid", pid, kNotNegative);
    v("protocol_version", protocol_version);
    v("state", state, OneOf<kStarting, kReady, kRunning, kFinished, kFailed>());
    v("rate_hz", rate_hz, Within{0, 1e9});
    v("processed", processed, kNotNegative);
    v("queued", queued, kNotNegative);
    v("dropped", dropped, kNotNegative);
    v("gaps", gaps, kNotNegative);
    v("rejected", rejected, kNotNegative);
    v("resent", resent, kNotNegative);
    v("cpu_s", cpu_s, Within{0, 1e12});
    v("rss_peak_mb", rss_peak_mb, Within{0, 1e12});
    v("message", message, Text{kMaxMessageLength});
  }
};

}  // namespace vpslam
