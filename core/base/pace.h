// Who waits for whom in the graph; docs/protocol.md has the flow of each.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vpslam {

enum class Pace {
  kLockstep,  ///< each image waits until the map has answered the one before; repeats exactly
  kLossless,  ///< as fast as all keep up; every frame is worked on, mapping runs beside tracking
  kRealtime,  ///< the tempo of the time stamps; who is too slow misses the oldest
};

inline const std::vector<std::string>& PaceNames() {
  static const std::vector<std::string> names = {"lockstep", "lossless", "realtime"};
  return names;
}

/// nullopt for what is none of PaceNames().
inline std::optional<Pace> PaceFromName(std::string_view name) {
  for (size_t i = 0; i < PaceNames().size(); ++i) {
    if (PaceNames()[i] == name) return static_cast<Pace>(i);
  }
  return std::nullopt;
}

}  // namespace vpslam
