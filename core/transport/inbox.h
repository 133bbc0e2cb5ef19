// Best-effort receiving of one type of message from one channel, through a bounded queue.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/transport/bus.h"
#include "core/transport/codec.h"
#include "core/transport/sequence_watch.h"

namespace vpslam {

template <class T>
class Inbox {
 public:
  static constexpr std::size_t kUnbounded = 0;

  /// A full queue drops its oldest message, counted unless `repeats`: what is said again and again
  /// is no loss. kUnbounded is for what is rare by nature.
  Inbox(Bus& bus, const std::string& channel, std::size_t capacity, bool repeats = false)
      : bus_(bus), channel_(channel), capacity_(capacity), repeats_(repeats) {
    registration_ = bus.Subscribe(channel, [this](std::span<const uint8_t> b) { Receive(b); });
  }

  std::optional<Decoded<T>> TryTake() {
    const std::lock_guard lock(mutex_);
    if (queue_.empty()) return std::nullopt;
    std::optional<Decoded<T>> message = std::move(queue_.front());
    queue_.pop_front();
    return message;
  }
  bool HasMessage() const { return size() > 0; }
  std::size_t size() const {
    const std::lock_guard lock(mutex_);
    return queue_.size();
  }
  int64_t dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  void Receive(std::span<const uint8_t> bytes) {
    std::string why;
    std::optional<Decoded<T>> message = Decode<T>(bytes, &why);
    if (!message) {
      CountRejected(bus_, channel_, why);
      return;
    }
    const std::lock_guard lock(mutex_);
    const SequenceWatch::Verdict verdict = watch_.See(message->header);
    bus_.counters().gaps += verdict.missed;
    if (!verdict.is_new || message->header.last) return;
    queue_.push_back(*std::move(message));
    if (capacity_ != kUnbounded && queue_.size() > capacity_) {
      queue_.pop_front();
      if (repeats_) return;
      ++dropped_;
      ++bus_.counters().dropped;
    }
  }

  Bus& bus_;
  const std::string channel_;
  const std::size_t capacity_;
  const bool repeats_;
  mutable std::mutex mutex_;
  std::deque<Decoded<T>> queue_;
  SequenceWatch watch_;
  int64_t dropped_ = 0;
  Bus::Registration registration_;  // last: its end stops Receive before the rest goes
};

}  // namespace vpslam
