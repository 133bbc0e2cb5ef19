// Keys of YAML files that people write by hand.
#pragma once

#include <span>
#include <string>

#include <yaml-cpp/yaml.h>

namespace vpslam {

/// Throws std::runtime_error naming a key that stands twice, of which one value would be ignored.
void RefuseRepeatedKeys(const YAML::Node& map);

/// Throws std::runtime_error naming a key that is none of `known`, and those that are.
void RefuseUnknownKeys(const YAML::Node& map, std::span<const char* const> known);

}  // namespace vpslam
