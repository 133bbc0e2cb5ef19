// Acknowledgement of a reliable stream by one consumer.
#pragma once

#include <cstdint>
#include <string>

namespace vpslam {

struct Ack {
  std::string stream;  ///< channel
  int64_t stream_session = 0;
  std::string consumer;
  int64_t received = -1;  ///< all messages up to this one have come
  int64_t done = -1;      ///< all up to this one need not be kept; <= received
};

}  // namespace vpslam
