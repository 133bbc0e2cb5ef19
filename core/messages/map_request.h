// A replica's plea for a snapshot of the map.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/description.h"

namespace vpslam {

struct MapRequest {
  std::string process;      ///< who asks
  int64_t map_version = 0;  ///< what its replica has; 0 for nothing

  static constexpr const char* kWireName = "map_request_t";
  static void Describe(auto& v, auto& m) {
    auto& [process, map_version] = m;
    v("process", process, ProcessName());
    v("map_version", map_version, kNotNegative);
  }
};

}  // namespace vpslam
