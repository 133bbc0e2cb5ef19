// What a log is the log of: enough to do the same run again.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/description.h"

namespace vpslam {

struct RunDescription {
  uint64_t seed = 1;
  std::string commit;
  std::string options = "{}";  ///< JSON object: what `vpslam run` was given

  static constexpr const char* kWireName = "run_t";
  static void Describe(auto& v, auto& m) {
    auto& [seed, commit, options] = m;
    v("seed", seed);
    v("commit", commit, Text{1024});
    v("options", options, Text{1 << 20});  // they may hold a settings file
  }
};

}  // namespace vpslam
