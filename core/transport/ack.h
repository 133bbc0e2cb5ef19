// Acknowledgement of a reliable stream by one consumer.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/description.h"

namespace vpslam {

struct Ack {
  std::string stream;  ///< channel
  int64_t stream_session = 0;
  std::string consumer;
  int64_t received = -1;  ///< all messages up to this one have come
  int64_t done = -1;      ///< all up to this one need not be kept; <= received

  static constexpr const char* kWireName = "ack_t";
  static void Describe(auto& v, auto& m) {
    auto& [stream, stream_session, consumer, received, done] = m;
    v("stream", stream, ProcessName());
    v("stream_session", stream_session);
    v("consumer", consumer, ProcessName());
    v("received", received, kIndexOrNone);
    v("done", done, kIndexOrNone);
  }
  std::optional<std::string> Validate() const {
    if (done > received) return "done: more than received";
    return std::nullopt;
  }
};

}  // namespace vpslam
