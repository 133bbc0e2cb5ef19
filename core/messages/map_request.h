// A replica's plea for a snapshot of the map.
#pragma once

#include <cstdint>
#include <string>

namespace vpslam {

struct MapRequest {
  std::string process;      ///< who asks
  int64_t map_version = 0;  ///< what its replica has; 0 for nothing
};

}  // namespace vpslam
