// JSON as text.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace vpslam {

/// With `indent` spaces per level, or on one line for -1. Strings may hold whatever came in, such
/// as the name of a file: bytes that are no UTF-8 are replaced.
inline std::string ToText(const nlohmann::ordered_json& json, int indent = -1) {
  return json.dump(indent, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace vpslam
