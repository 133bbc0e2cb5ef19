// Best-effort sending of one type of message on one channel.
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <utility>

#include "core/transport/bus.h"
#include "core/transport/clock.h"
#include "core/transport/codec.h"

namespace vpslam {

template <class T>
class Publisher {
 public:
  Publisher(Bus& bus, std::string channel) : bus_(bus), channel_(std::move(channel)) {}

  /// Any thread. Throws std::invalid_argument if the value may not be sent.
  void Publish(const T& value) {
    const std::lock_guard lock(mutex_);
    Header header;
    header.session = bus_.session();
    header.seq = header.oldest_seq = next_seq_;
    header.stamp_us = RealtimeMicroseconds();
    bus_.Publish(channel_, Encode(header, value));
    ++next_seq_;
  }

 private:
  Bus& bus_;
  const std::string channel_;
  std::mutex mutex_;
  int64_t next_seq_ = 0;
};

}  // namespace vpslam
