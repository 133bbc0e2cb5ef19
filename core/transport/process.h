// What all processes of the graph share: command line, log, signals, exit codes.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "core/base/pace.h"
#include "core/transport/bus.h"
#include "core/transport/peers.h"
#include "core/transport/status_reporter.h"

namespace CLI {
class App;
}

namespace vpslam {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;
inline constexpr int kExitUsage = 2;

struct ProcessOptions {
  std::string name;  ///< player, frontend, ...: in STATUS and in acknowledgements
  std::string url = BusOptions().url;
  int64_t session = 0;  ///< 0: a random one
  std::string log_level = "info";
  /// Processes whose acknowledgements the streams of this one wait for.
  std::vector<std::string> required;
  Pace pace = Pace::kLockstep;
  std::string record = "none";  ///< what the recorder keeps besides results: its log
  bool may_be_several = false;  ///< instances of this process in one graph

  bool IsRecorded() const { return record != "none"; }
};

/// "0.1.0 (commit abc1234, protocol 3)"
std::string VersionLine();
/// git commit at configure time, or "unknown".
std::string GitCommit();

/// Throws std::runtime_error, with one line, for an LCM URL over which no other process is reached.
void RequireGraphUrl(const std::string& url);

/// Adds --url, --session, --log-level, --require, --pace, --record and --version. `options` must
/// outlive the parsing and holds the defaults.
void AddProcessOptions(CLI::App& app, ProcessOptions* options);

/// One process in the graph.
struct Process {
  explicit Process(const ProcessOptions& options);

  const ProcessOptions options;
  Bus bus;
  Peers peers;
  StatusReporter status;

  /// Sees that messages come back to this process, and that no other instance of it, unless there
  /// may be several, has the graph already. Throws std::runtime_error with one line.
  void CheckGraph();

  /// What SIGINT, SIGTERM and SIGHUP do (the last not where it was ignored at the start, as by
  /// nohup); by default they interrupt the bus. The second signal always does.
  void OnStopSignal(std::function<void()> handler);
  void HandleStopSignal();

 private:
  void RefuseForerunner(const ProcessStatus& other, int64_t other_session) const;

  const Peers::Clock::time_point started_ = Peers::Clock::now();
  std::mutex mutex_;
  std::function<void()> stop_handler_;
  int signals_ = 0;
};

/// Parses the command line, sets up log, signals and bus, and runs `body`. An exception becomes one
/// line in the log, STATUS kFailed and kExitFailed, also one of a bus handler or timer. To be
/// called before any thread is started.
int RunProcess(CLI::App& app, int argc, char** argv, ProcessOptions* options,
               const std::function<int(Process&)>& body);

}  // namespace vpslam
