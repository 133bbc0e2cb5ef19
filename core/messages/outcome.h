// What became of the images of a sequence, told by the player in the end.
#pragma once

#include <cstddef>
#include <string>

#include "core/base/description.h"

namespace vpslam {

struct Outcome {
  static constexpr std::size_t kMaxLength = 16384;

  std::string json = "{}";  ///< object for summary.json; player/outcome.h has its members

  static constexpr const char* kWireName = "outcome_t";
  static void Describe(auto& v, auto& m) {
    auto& [json] = m;
    v("json", json, Text{kMaxLength});
  }
};

}  // namespace vpslam
