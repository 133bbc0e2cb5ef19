#include "core/transport/peers.h"

#include <algorithm>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/transport/channels.h"
#include "core/transport/sequence_watch.h"
#include "core/transport/stream_writer.h"

namespace vpslam {

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
  const std::lock_guard lock(mutex_);
  std::deque<Instance>& instances = peers_[status.process];
  const auto known = std::find_if(instances.begin(), instances.end(), [&](const Instance& i) {
    return i.session == message->header.session;
  });
  if (known != instances.end()) {
    instances.erase(known);
  } else if (status.protocol_version != kProtocolVersion) {
    spdlog::error(
        "{} (pid {}) speaks version {} of the protocol, this process {}; build both from "
        "one source",
        status.process, status.pid, status.protocol_version, kProtocolVersion);
  }
  instances.push_back({std::move(status), message->header.session, Clock::now()});
  if (instances.size() > kMaxInstances) instances.pop_front();
}

std::optional<ProcessStatus> Peers::Get(const std::string& process) const {
  const std::lock_guard lock(mutex_);
  const auto found = peers_.find(process);
  if (found == peers_.end()) return std::nullopt;
  return found->second.back().status;
}

std::optional<int64_t> Peers::Session(const std::string& process) const {
  const std::lock_guard lock(mutex_);
  const auto found = peers_.find(process);
  if (found == peers_.end()) return std::nullopt;
  return found->second.back().session;
}

std::vector<std::string> Peers::NotReady(const std::vector<std::string>& processes) const {
  const auto is_ready = [](const Instance& i) {
    return i.status.state == ProcessState::kReady || i.status.state == ProcessState::kRunning;
  };
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

bool Peers::WaitFor(const std::function<bool()>& predicate,
                    const std::vector<std::string>& processes) {
  constexpr std::chrono::milliseconds kLookAround{500};
  while (!bus_.WaitFor(predicate, kLookAround)) {
    if (bus_.interrupted()) return false;
    for (const std::string& process : processes) {
      if (const auto why = WhyGone(process); why && !predicate()) throw PeerGoneError(*why);
    }
  }
  return true;
}

}  // namespace vpslam
