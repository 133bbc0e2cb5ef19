// A small picture of what the frontend sees, for people: lcm-spy cannot receive large images.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace vpslam {

struct Preview {
  static constexpr std::size_t kMaxBytes = 60000;  ///< one datagram

  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  std::vector<uint8_t> jpeg;  ///< at most kMaxBytes
};

}  // namespace vpslam
