// What a log is the log of: enough to do the same run again.
#pragma once

#include <cstdint>
#include <string>

namespace vpslam {

struct RunDescription {
  uint64_t seed = 1;
  std::string commit;
  std::string options = "{}";  ///< JSON object: what `vpslam run` was given
};

}  // namespace vpslam
