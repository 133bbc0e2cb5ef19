#include "core/transport/status_reporter.h"

#include <algorithm>
#include <utility>

#include <sys/resource.h>
#include <unistd.h>

#include "core/transport/channels.h"

namespace vpslam {
namespace {

constexpr std::chrono::seconds kPeriod{1};

// Anything may stand in the text of an exception.
std::string Printable(std::string text) {
  std::replace(text.begin(), text.end(), '\0', ' ');
  constexpr std::size_t kMaxLength_bytes = ProcessStatus::kMaxMessageLength;
  if (text.size() > kMaxLength_bytes) text.resize(kMaxLength_bytes);
  return text;
}

rusage Usage() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage;
}

}  // namespace

double ProcessCpuSeconds() {
  const rusage usage = Usage();
  const auto seconds = [](const timeval& t) { return t.tv_sec + 1e-6 * t.tv_usec; };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double ProcessPeakRssMb() {
  return Usage().ru_maxrss * 1024 / 1e6;  // Linux counts in KiB
}

StatusReporter::StatusReporter(Bus& bus, const std::string& process)
    : bus_(bus),
      publisher_(bus, kStatusChannel),
      last_published_(std::chrono::steady_clock::now()) {
  status_.process = process;
  status_.pid = getpid();
  {
    const std::lock_guard lock(mutex_);
    PublishLocked();
  }
  timer_ = bus.OnTick([this] { Tick(); });
}

StatusReporter::~StatusReporter() {
  timer_.Cancel();
  const std::lock_guard lock(mutex_);
  PublishLocked();
}

void StatusReporter::SetState(ProcessState state, const std::string& message) {
  const std::lock_guard lock(mutex_);
  status_.state = state;
  status_.message = Printable(message);
  PublishLocked();
}

void StatusReporter::PublishNow() {
  const std::lock_guard lock(mutex_);
  PublishLocked();
}

void StatusReporter::AddProcessed(int64_t count) {
  const std::lock_guard lock(mutex_);
  status_.processed += count;
}

void StatusReporter::SetQueued(int64_t count) {
  const std::lock_guard lock(mutex_);
  status_.queued = count;
}

Bus::Registration StatusReporter::WatchQueue(std::function<int64_t()> count) {
  const std::lock_guard lock(mutex_);
  queued_ = std::move(count);
  return Bus::Registration([this] {
    const std::lock_guard cancel_lock(mutex_);
    status_.queued = queued_();
    queued_ = nullptr;
  });
}

ProcessStatus StatusReporter::Snapshot() const {
  const std::lock_guard lock(mutex_);
  return SnapshotLocked();
}

void StatusReporter::Tick() {
  const auto now = std::chrono::steady_clock::now();
  const std::lock_guard lock(mutex_);
  if (now - last_published_ < kPeriod) return;
  const double seconds = std::chrono::duration<double>(now - last_rated_).count();
  status_.rate_hz = static_cast<double>(status_.processed - processed_at_last_) / seconds;
  processed_at_last_ = status_.processed;
  last_rated_ = now;
  PublishLocked();
}

void StatusReporter::PublishLocked() {
  last_published_ = std::chrono::steady_clock::now();
  publisher_.Publish(SnapshotLocked());
}

ProcessStatus StatusReporter::SnapshotLocked() const {
  ProcessStatus status = status_;
  if (queued_) status.queued = queued_();
  const BusCounters& counters = bus_.counters();
  status.dropped = counters.dropped;
  status.gaps = counters.gaps;
  status.rejected = counters.rejected;
  status.resent = counters.resent;
  status.cpu_s = ProcessCpuSeconds();
  status.rss_peak_mb = ProcessPeakRssMb();
  return status;
}

}  // namespace vpslam
