// A small picture of what the frontend sees, for people: lcm-spy cannot receive large images.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/description.h"

namespace vpslam {

struct Preview {
  static constexpr std::size_t kMaxBytes = 60000;  ///< one datagram

  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  std::vector<uint8_t> jpeg;  ///< at most kMaxBytes

  static constexpr const char* kWireName = "preview_t";
  static void Describe(auto& v, auto& m) {
    auto& [frame_seq, stamp_us, jpeg] = m;
    v("frame_seq", frame_seq, kNotNegative);
    v("stamp_us", stamp_us);
    v.Array("num_bytes", "jpeg", jpeg);
  }
  std::optional<std::string> Validate() const {
    if (jpeg.empty() || jpeg.size() > kMaxBytes) return "jpeg: size out of range";
    return std::nullopt;
  }
};

}  // namespace vpslam
