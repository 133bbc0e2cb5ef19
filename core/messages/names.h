// Names that travel in messages.
#pragma once

#include <cstddef>
#include <string>

namespace vpslam {

inline constexpr std::size_t kMaxNameLength = 64;

/// Letters, digits, '-', '_' or '.'; 1 to kMaxNameLength of them.
bool IsProcessName(const std::string& name);
/// "/vpslam-" and then letters, digits, '-', '_' or '.'; at most kMaxNameLength in all.
bool IsImageSegmentName(const std::string& name);

}  // namespace vpslam
