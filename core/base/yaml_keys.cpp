#include "core/base/yaml_keys.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string_view>

namespace vpslam {
namespace {

std::string Key(const YAML::Node& key) {
  return key.IsScalar() ? key.Scalar() : std::string("(no name)");
}

std::string LineOf(const YAML::Node& key) {
  return "line " + std::to_string(key.Mark().line + 1) + ": ";
}

}  // namespace

void RefuseRepeatedKeys(const YAML::Node& map) {
  std::set<std::string> seen;
  for (const auto& entry : map) {
    if (!seen.insert(Key(entry.first)).second) {
      throw std::runtime_error(LineOf(entry.first) + "the key '" + Key(entry.first) +
                               "' stands there twice; remove one");
    }
  }
}

void RefuseUnknownKeys(const YAML::Node& map, std::span<const char* const> known) {
  for (const auto& entry : map) {
    const std::string key = Key(entry.first);
    const auto same = [&](const char* name) { return key == name; };
    if (std::any_of(known.begin(), known.end(), same)) continue;
    std::string names;
    for (const char* name : known) names += (names.empty() ? "" : ", ") + std::string(name);
    throw std::runtime_error(LineOf(entry.first) + "there is no key '" + key + "'; there are " +
                             names);
  }
}

}  // namespace vpslam
