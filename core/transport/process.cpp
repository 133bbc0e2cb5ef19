#include "core/transport/process.h"

#include <atomic>
#include <chrono>
#include <csignal>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <thread>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <malloc.h>
#include <pthread.h>
#include <signal.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "core/transport/version.h"

namespace vpslam {
namespace {

BusOptions MakeBusOptions(const ProcessOptions& options) {
  RequireGraphUrl(options.url);
  BusOptions bus;
  bus.url = options.url;
  bus.session = options.session;
  return bus.WithEnvironment();
}

void SetUpLog(const ProcessOptions& options) {
  auto logger = spdlog::stderr_logger_mt(options.name);
  logger->set_pattern("%H:%M:%S.%e " + options.name + " %L %v");
  spdlog::set_default_logger(std::move(logger));
  spdlog::set_level(spdlog::level::from_str(options.log_level));
}

sigset_t StopSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  // nohup has it ignored, and a blocked signal is not: it would end the process all the same.
  struct sigaction hangup {};
  if (sigaction(SIGHUP, nullptr, &hangup) == 0 && hangup.sa_handler != SIG_IGN) {
    sigaddset(&signals, SIGHUP);
  }
  return signals;
}

// Waits for the stop signals on a thread of its own, where everything may be called. They have to
// be blocked in all threads.
class SignalThread {
 public:
  explicit SignalThread(std::function<void()> handler)
      : thread_([this, handler = std::move(handler)] {
          const sigset_t signals = StopSignals();
          int signal = 0;
          while (sigwait(&signals, &signal) == 0 && !stop_) {
            spdlog::info("stopping (SIG{})", sigabbrev_np(signal));
            handler();
          }
        }) {}
  ~SignalThread() {
    stop_ = true;
    pthread_kill(thread_.native_handle(), SIGTERM);
    thread_.join();
  }
  SignalThread(const SignalThread&) = delete;
  SignalThread& operator=(const SignalThread&) = delete;

 private:
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

/// glibc gives every buffer of the size of an image back to the kernel and asks for it again for
/// the next one; clearing its pages can cost as much as filling them.
void KeepFreedMemory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most that is allowed
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

}  // namespace

std::string GitCommit() { return VPSLAM_GIT_COMMIT; }

std::string VersionLine() {
  return fmt::format("{} (commit {}, protocol {})", VPSLAM_VERSION, GitCommit(), kProtocolVersion);
}

void RequireGraphUrl(const std::string& url) {
  if (url.starts_with("udpm://")) return;
  throw std::runtime_error("--url " + url +
                           ": reaches no other process; a graph needs udpm://, such as " +
                           BusOptions().url);
}

void AddProcessOptions(CLI::App& app, ProcessOptions* options) {
  app.set_version_flag("--version", options->name + " " + VersionLine());
  app.add_option("--url", options->url, "LCM URL of the graph")->capture_default_str();
  app.add_option("--session", options->session, "session id of this process; 0 for a random one")
      ->capture_default_str();
  app.add_option("--log-level", options->log_level, "how much goes to standard error")
      ->check(CLI::IsMember({"debug", "info", "warn", "error"}))
      ->capture_default_str();
  app.add_option("--require", options->required,
                 "processes whose acknowledgements are waited for, separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option_function<std::string>(
         "--pace", [options](const std::string& name) { options->pace = *PaceFromName(name); },
         "who waits for whom: lockstep repeats exactly, lossless is as fast as all keep up, "
         "realtime keeps the time stamps' tempo and drops what comes too fast")
      ->check(CLI::IsMember(PaceNames()))
      ->default_str("lockstep");
  app.add_option("--record", options->record,
                 "what the recorder logs: 'features' of each frame, or 'all', with pixels; the "
                 "same for all processes of a graph")
      ->check(CLI::IsMember({"none", "features", "all"}))
      ->capture_default_str();
}

Process::Process(const ProcessOptions& process_options)
    : options(process_options),
      bus(MakeBusOptions(process_options)),
      peers(bus),
      status(bus, process_options.name) {
  peers.OnNewInstance([this](const ProcessStatus& other, int64_t session) {
    if (session == bus.session()) return;
    status.PublishNow();  // whoever comes learns at once who is there
    if (other.process == options.name && !options.may_be_several) RefuseForerunner(other, session);
  });
}

void Process::RefuseForerunner(const ProcessStatus& other, int64_t other_session) const {
  // The one that was here first goes on: it hears of a newcomer when that starts. Of two that
  // start at a time one has to give way.
  constexpr std::chrono::seconds kNewcomer{3};
  const bool is_new = Peers::Clock::now() - started_ < kNewcomer;
  const bool is_earlier =
      other.state == ProcessState::kRunning ||
      (other.state == ProcessState::kReady &&
       (status.Snapshot().state == ProcessState::kStarting || other_session < bus.session()));
  if (!is_new || !is_earlier) return;
  throw std::runtime_error(
      fmt::format("another {} (pid {}) is at work on {}; end it, or give this graph a port of its "
                  "own with --url",
                  options.name, other.pid, bus.url()));
}

void Process::CheckGraph() {
  constexpr int kTries = 50;
  constexpr std::chrono::milliseconds kPerTry{100}, kForAnswers{50};
  const auto hears_itself = [this] { return peers.NeverHeard({options.name}).empty(); };
  int tries = 0;
  while (!bus.WaitFor(hears_itself, kPerTry) && !bus.interrupted()) {
    status.PublishNow();  // a network may lose some
    if (++tries < kTries) continue;
    throw std::runtime_error(
        fmt::format("what is sent to {} does not come back; does a firewall drop UDP to "
                    "224.0.0.0/4, or has the route for multicast gone?",
                    bus.url()));
  }
  if (!options.may_be_several) bus.WaitFor([] { return false; }, kForAnswers);
}

void Process::OnStopSignal(std::function<void()> handler) {
  const std::lock_guard lock(mutex_);
  stop_handler_ = std::move(handler);
}

void Process::HandleStopSignal() {
  const std::lock_guard lock(mutex_);
  if (signals_++ == 0 && stop_handler_) {
    stop_handler_();
  } else {
    bus.Interrupt();
  }
}

int RunProcess(CLI::App& app, int argc, char** argv, ProcessOptions* options,
               const std::function<int(Process&)>& body) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? kExitOk : kExitUsage;
  }
  SetUpLog(*options);
  KeepFreedMemory();
  try {
    const sigset_t signals = StopSignals();
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // inherited by all threads
    // A disk quota and a reader that went away are errors of a write, which say more.
    std::signal(SIGXFSZ, SIG_IGN);
    std::signal(SIGPIPE, SIG_IGN);
    Process process(*options);
    const SignalThread signal_thread([&process] { process.HandleStopSignal(); });
    try {
      process.CheckGraph();
      const int code = body(process);
      process.bus.ThrowFailure();
      process.status.SetState(code == kExitOk ? ProcessState::kFinished : ProcessState::kFailed);
      return code;
    } catch (const std::exception& e) {
      process.status.SetState(ProcessState::kFailed, e.what());
      throw;
    }
  } catch (const std::exception& e) {
    spdlog::error("{}", e.what());
    return kExitFailed;
  }
}

}  // namespace vpslam
