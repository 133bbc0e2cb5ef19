#include "core/transport/peers.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "core/transport/channels.h"
#include "core/transport/sequence_watch.h"
#include "core/transport/stream_writer.h"

namespace vpslam {
namespace {

bool IsAtWork(const ProcessStatus& status) {
  return status.state == ProcessState::kReady || status.state == ProcessState::kRunning;
}

}  // namespace

Peers::Peers(Bus& bus, std::chrono::milliseconds silence) : bus_(bus), silence_(silence) {
  registration_ =
      bus.Subscribe(kStatusChannel, [this](std::span<const uint8_t> bytes) { Receive(bytes); });
}

void Peers::Receive(std::span<const uint8_t> bytes) {
  std::string why;
  std::optional<Decoded<ProcessStatus>> message = Decode<ProcessStatus>(bytes, &why);
  if (!message) {
    CountRejected(bus_, kStatusChannel, why);
    return;
  }
  ProcessStatus& status = message->value;
  const int64_t session = message->header.session;
  std::unique_lock lock(mutex_);
  std::deque<Instance>& instances = peers_[status.process];
  const auto known = std::find_if(instances.begin(), instances.end(),
                                  [&](const Instance& i) { return i.session == session; });
  const bool is_new = known == instances.end();
  if (!is_new) {
    instances.erase(known);
  } else if (status.protocol_version != kProtocolVersion) {
    spdlog::error(
        "{} (pid {}) speaks version {} of the protocol, this process {}; build both from "
        "one source",
        status.process, status.pid, status.protocol_version, kProtocolVersion);
  }
  instances.push_back({status, session, Clock::now()});
  if (instances.size() > kMaxInstances) instances.pop_front();
  if (!is_new || !on_new_) return;
  const OnNew on_new = on_new_;
  lock.unlock();  // it may ask this object
  on_new(status, session);
}

void Peers::OnNewInstance(OnNew on_new) {
  std::vector<Instance> known;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [name, instances] : peers_) {
      known.insert(known.end(), instances.begin(), instances.end());
    }
    on_new_ = on_new;
  }
  for (const Instance& instance : known) on_new(instance.status, instance.session);
}

const Peers::Instance* Peers::FindLocked(const std::string& process) const {
  const auto found = peers_.find(process);
  if (found == peers_.end()) return nullptr;
  const std::deque<Instance>& instances = found->second;
  for (const bool at_work : {true, false}) {
    const auto last = std::find_if(instances.rbegin(), instances.rend(), [&](const Instance& i) {
      return at_work ? IsAtWork(i.status) : i.status.state == ProcessState::kStarting;
    });
    if (last != instances.rend()) return &*last;
  }
  return &instances.back();
}

std::optional<ProcessStatus> Peers::Get(const std::string& process) const {
  const std::lock_guard lock(mutex_);
  const Instance* instance = FindLocked(process);
  return instance ? std::optional(instance->status) : std::nullopt;
}

std::optional<int64_t> Peers::Session(const std::string& process) const {
  const std::lock_guard lock(mutex_);
  const Instance* instance = FindLocked(process);
  return instance ? std::optional(instance->session) : std::nullopt;
}

std::vector<std::string> Peers::NotReady(const std::vector<std::string>& processes) const {
  const auto is_ready = [](const Instance& i) { return IsAtWork(i.status); };
  const std::lock_guard lock(mutex_);
  std::vector<std::string> missing;
  for (const std::string& process : processes) {
    const auto found = peers_.find(process);
    if (found == peers_.end() ||
        std::none_of(found->second.begin(), found->second.end(), is_ready)) {
      missing.push_back(process);
    }
  }
  return missing;
}

bool Peers::WaitReady(const std::vector<std::string>& processes,
                      std::chrono::milliseconds timeout) {
  return bus_.WaitFor([&] { return NotReady(processes).empty(); }, timeout);
}

std::optional<std::string> Peers::WhyGone(const std::string& process) const {
  const std::lock_guard lock(mutex_);
  const auto found = peers_.find(process);
  if (found == peers_.end()) return std::nullopt;
  std::optional<std::string> why;
  for (const Instance& instance : found->second) {
    why = WhyGone(process, instance);
    if (!why) return std::nullopt;
  }
  return why;
}

std::optional<std::string> Peers::WhyGone(const std::string& process,
                                          const Instance& instance) const {
  if (instance.status.state == ProcessState::kFailed) {
    return fmt::format("{} failed: {}", process, instance.status.message);
  }
  if (instance.status.state == ProcessState::kFinished) {
    return fmt::format("{} has ended already", process);
  }
  const auto silent = Clock::now() - instance.heard;
  if (silent > silence_) {
    return fmt::format("{} has been silent for {} s; did it die?", process,
                       std::chrono::duration_cast<std::chrono::seconds>(silent).count());
  }
  return std::nullopt;
}

std::vector<std::string> Peers::NeverHeard(const std::vector<std::string>& processes) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> unheard;
  for (const std::string& process : processes) {
    if (!peers_.contains(process)) unheard.push_back(process);
  }
  return unheard;
}

std::optional<std::string> Peers::WhyGoneOrNeverComing(const std::string& process) const {
  if (NeverHeard({process}).empty()) return WhyGone(process);
  const auto why = WhyGone("player");  // with it the run is over
  if (!why) return std::nullopt;
  return fmt::format("{}, and nothing was ever heard of {}", *why, process);
}

bool Peers::WaitFor(const std::function<bool()>& predicate,
                    const std::vector<std::string>& processes) {
  constexpr std::chrono::milliseconds kLookAround{500};
  UnheardNotice notice;
  while (!bus_.WaitFor(predicate, kLookAround)) {
    if (bus_.interrupted()) return false;
    notice.Look(bus_, *this, processes);
    for (const std::string& process : processes) {
      if (const auto why = WhyGoneOrNeverComing(process); why && !predicate()) {
        throw PeerGoneError(*why);
      }
    }
  }
  return true;
}

void UnheardNotice::Look(const Bus& bus, const Peers& peers,
                         const std::vector<std::string>& processes) {
  const auto waited = Peers::Clock::now() - start_;
  if (waited < next_) return;
  next_ *= 2;
  const std::vector<std::string> unheard = peers.NeverHeard(processes);
  if (unheard.empty()) return;
  spdlog::warn("nothing heard of {} for {} s; start it with --url '{}', on this host",
               fmt::join(unheard, ", "),
               std::chrono::duration_cast<std::chrono::seconds>(waited).count(), bus.url());
}

}  // namespace vpslam
