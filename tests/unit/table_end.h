// For loops over all ids that ever were, the erased among them.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/map/map.h"

namespace vpslam {

/// One more than the greatest index in the table; 0 if it is empty.
template <class Id, class T>
int EndOf(const IdTable<Id, T>& table) {
  int64_t end = 0;
  for (const T& each : table) end = std::max(end, each.id.index() + 1);
  return static_cast<int>(end);
}

/// Culled ones, too.
inline int KeyframeEnd(const Map& map) {
  return std::max(EndOf(map.keyframes()), EndOf(map.culled_keyframes()));
}

}  // namespace vpslam
