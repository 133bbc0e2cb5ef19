#include "core/transport/bus.h"

#include <algorithm>
#include <cerrno>
#include <condition_variable>
#include <cstdlib>
#include <exception>
#include <functional>
#include <list>
#include <map>
#include <mutex>
#include <random>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <lcm/lcm.h>
#include <netinet/in.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/eventfd.h>
#include <unistd.h>

namespace vpslam {
namespace {

bool StartsWith(const std::string& text, const char* prefix) { return text.rfind(prefix, 0) == 0; }

int64_t RandomSession() {
  std::random_device device;
  const uint64_t bits = static_cast<uint64_t>(device()) << 32 | device();
  return static_cast<int64_t>(bits >> 1) + 1;  // positive
}

// Fills in what keeps a local graph local and its bursts from being lost.
/// The host of udpm://HOST:PORT?...; empty for LCM's default.
std::string HostOf(const std::string& url) {
  const std::size_t begin = std::string("udpm://").size();
  return url.substr(begin, url.find_first_of(":?/", begin) - begin);
}

bool IsMulticast(const std::string& host) {
  in_addr address{};
  return inet_aton(host.c_str(), &address) != 0 && IN_MULTICAST(ntohl(address.s_addr));
}

std::string CompleteUrl(const BusOptions& options) {
  std::string url = options.url;
  if (!StartsWith(url, "udpm://")) return url;
  const auto add = [&url](const std::string& key, int value) {
    if (url.find(key + "=") != std::string::npos) return;
    url += (url.find('?') == std::string::npos ? "?" : "&") + key + "=" + std::to_string(value);
  };
  add("ttl", 0);
  add("recv_buf_size", options.receive_buffer);
  return url;
}

}  // namespace

BusOptions BusOptions::WithEnvironment() const {
  BusOptions options = *this;
  if (const char* value = std::getenv("VPSLAM_RECV_BUFFER")) {
    options.receive_buffer = std::atoi(value);
  }
  if (const char* value = std::getenv("VPSLAM_DROP")) options.drop_share = std::atof(value);
  if (const char* value = std::getenv("VPSLAM_DROP_SEED")) {
    options.drop_seed = std::strtoull(value, nullptr, 10);
  }
  return options;
}

std::optional<std::string> BusOptions::Validate() const {
  if (!StartsWith(url, "udpm://") && !StartsWith(url, "memq://") && !StartsWith(url, "file://")) {
    return "url '" + url + "' starts with none of udpm://, memq:// and file://";
  }
  if (StartsWith(url, "udpm://")) {
    const std::string host = HostOf(url);
    if (!host.empty() && !IsMulticast(host)) {
      return "url '" + url + "': " + host +
             " is no multicast address; take one of 224.0.0.0 to 239.255.255.255, such as "
             "239.255.76.67";
    }
  }
  if (receive_buffer <= 0) return "the receive buffer must have a size > 0";
  if (!(drop_share >= 0 && drop_share < 1))
    return "the share of dropped messages must be in [0, 1)";
  return std::nullopt;
}

class Bus::Impl {
 public:
  explicit Impl(const BusOptions& options)
      : url_(CompleteUrl(options)),
        session_(options.session != 0 ? options.session : RandomSession()),
        drop_share_(options.drop_share),
        drop_random_(options.drop_seed) {
    if (const auto why = options.Validate()) throw std::runtime_error(*why);
    lcm_ = lcm_create(url_.c_str());
    if (!lcm_) {
      throw std::runtime_error(
          StartsWith(url_, "udpm://")
              ? fmt::format("cannot join {}: there is no route for multicast; type 'ip link set lo "
                            "up; ip route add 224.0.0.0/4 dev lo' as root",
                            url_)
              : fmt::format("cannot open {}: check the path and its permissions", url_));
    }
    wake_fd_ = eventfd(0, EFD_CLOEXEC);
    timer_thread_ = std::thread([this] { RunTimer(); });
    // A log is read from when someone waits for it, so that nothing is missed before.
    const bool is_file = StartsWith(url_, "file://");
    reads_log_ = is_file && url_.find("mode=w") == std::string::npos;
    if (!is_file) StartReceiving();
  }

  ~Impl() {
    Interrupt();
    {
      const std::lock_guard lock(timer_mutex_);
      timer_stop_ = true;
    }
    timer_wake_.notify_all();
    timer_thread_.join();
    const uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = write(wake_fd_, &one, sizeof one);
    if (receive_thread_.joinable()) receive_thread_.join();
    close(wake_fd_);
    lcm_destroy(lcm_);
  }

  int64_t session() const { return session_; }
  const std::string& url() const { return url_; }
  BusCounters& counters() { return counters_; }

  void Publish(const std::string& channel, std::span<const uint8_t> bytes) {
    if (lcm_publish(lcm_, channel.c_str(), bytes.data(), static_cast<unsigned>(bytes.size())) !=
        0) {
      if (!publish_failed_.exchange(true)) {
        spdlog::warn("LCM could not send a message of {} bytes on {}", bytes.size(), channel);
      }
      return;
    }
    ++counters_.sent;
  }

  Registration Subscribe(const std::string& channel, Handler handler) {
    const std::lock_guard lock(dispatch_mutex_);
    auto [found, is_new] = channels_.try_emplace(channel);
    Channel* entry = &found->second;
    if (is_new) {
      entry->impl = this;
      lcm_subscription_t* subscription =
          lcm_subscribe(lcm_, channel.c_str(), &Impl::OnMessage, entry);
      if (!subscription)
        throw std::runtime_error("LCM cannot subscribe to " + channel + " on " + url_);
      // Our own queues decide what to drop, and count it.
      lcm_subscription_set_queue_capacity(subscription, 0);
    }
    entry->handlers.push_back(std::move(handler));
    const auto position = std::prev(entry->handlers.end());
    return Registration([this, entry, position] {
      const std::lock_guard cancel_lock(dispatch_mutex_);
      entry->handlers.erase(position);
    });
  }

  Registration OnTick(TimerHandler handler) {
    const std::lock_guard lock(timer_mutex_);
    timers_.push_back(std::move(handler));
    const auto position = std::prev(timers_.end());
    return Registration([this, position] {
      const std::lock_guard cancel_lock(timer_mutex_);
      timers_.erase(position);
    });
  }

  bool WaitFor(const std::function<bool()>& predicate, std::chrono::milliseconds timeout) {
    if (reads_log_) std::call_once(log_started_, [this] { StartReceiving(); });
    const auto deadline = std::chrono::steady_clock::now() + timeout;
    std::unique_lock lock(event_mutex_);
    while (true) {
      if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
      if (interrupted_) return false;
      // The predicate runs unlocked; what happens meanwhile shows in the number of events.
      const uint64_t seen = events_;
      lock.unlock();
      if (predicate()) return true;
      lock.lock();
      if (!event_.wait_until(lock, deadline, [&] {
            return events_ != seen || interrupted_.load() || failure_ != nullptr;
          })) {
        return false;
      }
    }
  }

  void ThrowFailure() {
    const std::lock_guard lock(event_mutex_);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
  }

  void Notify() {
    {
      const std::lock_guard lock(event_mutex_);
      ++events_;
    }
    event_.notify_all();
  }

  void Interrupt() {
    {
      const std::lock_guard lock(event_mutex_);
      interrupted_ = true;
    }
    event_.notify_all();
  }

  bool interrupted() const { return interrupted_; }

 private:
  struct Channel {
    Impl* impl = nullptr;
    std::list<Handler> handlers;
  };

  static void OnMessage(const lcm_recv_buf_t* buffer, const char* /*channel*/, void* user) {
    auto* entry = static_cast<Channel*>(user);
    entry->impl->Dispatch(*entry, {static_cast<const uint8_t*>(buffer->data),
                                   static_cast<std::size_t>(buffer->data_size)});
  }

  void Dispatch(const Channel& entry, std::span<const uint8_t> bytes) {
    {
      const std::lock_guard lock(dispatch_mutex_);
      ++counters_.received;
      for (const Handler& handler : entry.handlers) {
        // Drawn for each receiver, as if each were a process of its own.
        if (drop_share_ > 0 && drop_uniform_(drop_random_) < drop_share_) {
          ++counters_.lost_on_purpose;
          continue;
        }
        Guard([&] { handler(bytes); });
      }
    }
    Notify();
  }

  // Handlers run below LCM's C code, or below a thread's first function, which no exception may
  // leave. The first one that is thrown is kept for the thread that waits.
  void Guard(const std::function<void()>& handler) {
    try {
      handler();
    } catch (...) {
      Fail(std::current_exception());
    }
  }

  void Fail(std::exception_ptr failure) {
    {
      const std::lock_guard lock(event_mutex_);
      if (std::exchange(has_failed_, true)) return;
      failure_ = std::move(failure);
    }
    event_.notify_all();
  }

  void StartReceiving() {
    receive_thread_ = std::thread([this] { RunReceive(); });
  }

  void RunReceive() {
    pollfd fds[2] = {{lcm_get_fileno(lcm_), POLLIN, 0}, {wake_fd_, POLLIN, 0}};
    while (true) {
      if (poll(fds, 2, -1) < 0) {
        if (errno == EINTR) continue;
        Fail(std::make_exception_ptr(std::system_error(errno, std::generic_category(), "poll")));
        break;
      }
      if (fds[1].revents != 0) break;
      if (fds[0].revents == 0 || lcm_handle(lcm_) == 0) continue;
      if (!reads_log_) {  // which ends so
        Fail(std::make_exception_ptr(std::runtime_error("LCM cannot receive from " + url_ +
                                                        " any more; start this process again")));
      }
      break;
    }
  }

  void RunTimer() {
    std::unique_lock lock(timer_mutex_);
    while (!timer_wake_.wait_for(lock, kTick, [this] { return timer_stop_; })) {
      for (const TimerHandler& handler : timers_) Guard(handler);
    }
  }

  const std::string url_;
  const int64_t session_;
  lcm_t* lcm_ = nullptr;
  int wake_fd_ = -1;
  BusCounters counters_;
  std::atomic<bool> publish_failed_{false};

  std::mutex dispatch_mutex_;  // held while handlers run
  std::map<std::string, Channel> channels_;
  const double drop_share_;
  std::mt19937_64 drop_random_;
  std::uniform_real_distribution<double> drop_uniform_{0, 1};

  std::mutex event_mutex_;
  std::condition_variable event_;
  uint64_t events_ = 0;
  std::atomic<bool> interrupted_{false};
  std::exception_ptr failure_;  // of a handler, until it was thrown on
  bool has_failed_ = false;

  std::mutex timer_mutex_;  // held while timer handlers run
  std::condition_variable timer_wake_;
  std::list<TimerHandler> timers_;
  bool timer_stop_ = false;

  bool reads_log_ = false;
  std::once_flag log_started_;
  std::thread timer_thread_;
  std::thread receive_thread_;
};

Bus::Bus(const BusOptions& options) : impl_(std::make_unique<Impl>(options)) {}
Bus::~Bus() = default;
int64_t Bus::session() const { return impl_->session(); }
const std::string& Bus::url() const { return impl_->url(); }
BusCounters& Bus::counters() { return impl_->counters(); }
void Bus::Publish(const std::string& channel, std::span<const uint8_t> bytes) {
  impl_->Publish(channel, bytes);
}
Bus::Registration Bus::Subscribe(const std::string& channel, Handler handler) {
  return impl_->Subscribe(channel, std::move(handler));
}
Bus::Registration Bus::OnTick(TimerHandler handler) { return impl_->OnTick(std::move(handler)); }
bool Bus::WaitFor(const std::function<bool()>& predicate, std::chrono::milliseconds timeout) {
  return impl_->WaitFor(predicate, timeout);
}
void Bus::ThrowFailure() { impl_->ThrowFailure(); }
void Bus::Notify() { impl_->Notify(); }
void Bus::Interrupt() { impl_->Interrupt(); }
bool Bus::interrupted() const { return impl_->interrupted(); }

}  // namespace vpslam
