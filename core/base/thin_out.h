// Taking some of many, evenly.
#pragma once

#include <cstddef>

namespace vpslam {

/// The step with which a loop over `size` elements visits at most `max_visited` of them (1 or
/// more), evenly. At least 1, so that the loop ends.
constexpr std::size_t ThinOutStep(std::size_t size, std::size_t max_visited) {
  return size <= max_visited ? 1 : (size + max_visited - 1) / max_visited;
}

}  // namespace vpslam
