// A process's connection to the graph: one LCM instance, one receive thread, one timer thread.
//
// Handlers run on the receive thread and only put messages into queues; a worker sleeps in WaitFor
// until what it needs is there, whichever inbox it comes from. An exception that a handler throws
// ends neither thread: it is kept, and thrown on to the worker.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

namespace vpslam {

struct BusOptions {
  /// udpm://group:port for processes, memq:// inside one process (all parties share one Bus),
  /// file://PATH?speed=0 to read a log, file://PATH?mode=w to write one. For udpm, `ttl=0` and
  /// `recv_buf_size` are filled in where the URL does not give them.
  std::string url = "udpm://239.255.76.67:7667";
  int64_t session = 0;           ///< 0: a random one
  int receive_buffer = 4 << 20;  ///< bytes asked of the kernel, which may give less
  double drop_share = 0;         ///< for tests: share of received messages thrown away
  uint64_t drop_seed = 1;

  /// `*this` with what VPSLAM_RECV_BUFFER, VPSLAM_DROP and VPSLAM_DROP_SEED say.
  BusOptions WithEnvironment() const;
  std::optional<std::string> Validate() const;
};

/// What the transport of this process has seen so far.
struct BusCounters {
  std::atomic<int64_t> received{0};
  std::atomic<int64_t> sent{0};
  std::atomic<int64_t> lost_on_purpose{0};  ///< by drop_share
  std::atomic<int64_t> rejected{0};         ///< malformed or alien
  std::atomic<int64_t> dropped{0};          ///< from full queues
  std::atomic<int64_t> gaps{0};             ///< sequence numbers that never came
  std::atomic<int64_t> resent{0};
};

class Bus {
 public:
  using Handler = std::function<void(std::span<const uint8_t>)>;
  using TimerHandler = std::function<void()>;
  static constexpr std::chrono::milliseconds kTick{25};

  /// Ends what it stands for when destroyed; no handler runs after that. To be destroyed before the
  /// bus, and never from within a handler.
  class Registration {
   public:
    Registration() = default;
    explicit Registration(std::function<void()> cancel) : cancel_(std::move(cancel)) {}
    Registration(Registration&& other) noexcept { *this = std::move(other); }
    Registration& operator=(Registration&& other) noexcept {
      Cancel();
      cancel_ = std::move(other.cancel_);
      other.cancel_ = nullptr;
      return *this;
    }
    ~Registration() { Cancel(); }
    void Cancel() {
      if (cancel_) cancel_();
      cancel_ = nullptr;
    }

   private:
    std::function<void()> cancel_;
  };

  /// Throws std::runtime_error with one line that names fault and remedy.
  explicit Bus(const BusOptions& options);
  ~Bus();
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  int64_t session() const;
  const std::string& url() const;  ///< as given to LCM
  BusCounters& counters();

  /// May be called from any thread, also from handlers.
  void Publish(const std::string& channel, std::span<const uint8_t> bytes);
  [[nodiscard]] Registration Subscribe(const std::string& channel, Handler handler);
  /// Called every kTick on the timer thread.
  [[nodiscard]] Registration OnTick(TimerHandler handler);

  /// Sleeps until `predicate()`, which is evaluated without any lock held, whenever something was
  /// received or Notify was called. False after `timeout` or Interrupt. Throws what a handler threw
  /// (the first exception of all, once), or std::runtime_error if nothing can be received any more.
  bool WaitFor(const std::function<bool()>& predicate, std::chrono::milliseconds timeout);
  /// Throws what WaitFor would throw; for a worker that waits no more.
  void ThrowFailure();
  void Notify();
  /// Ends every WaitFor, now and in future: the process is to stop. Not for signal handlers.
  void Interrupt();
  bool interrupted() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vpslam
