// The tracker's enumerations as settings: by name, in a file, on the command line, in the log.
#pragma once

#include <array>
#include <ostream>
#include <string>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "frontend/tracker_options.h"

namespace vpslam {

inline constexpr std::array kRotationModes = {std::pair{RotationMode::kOff, "off"},
                                              std::pair{RotationMode::kPaper, "paper"},
                                              std::pair{RotationMode::kFused, "fused"}};
inline constexpr std::array kTranslationModes = {std::pair{TranslationMode::kOff, "off"},
                                                 std::pair{TranslationMode::kPaper, "paper"},
                                                 std::pair{TranslationMode::kWeighted, "weighted"}};

template <class Modes, class Mode>
std::ostream& WriteMode(std::ostream& out, const Modes& modes, Mode mode) {
  for (const auto& [value, name] : modes) {
    if (value == mode) out << name;
  }
  return out;
}

template <class Modes, class Mode>
bool ReadMode(const YAML::Node& node, const Modes& modes, Mode* mode) {
  const auto text = node.as<std::string>();
  for (const auto& [value, name] : modes) {
    if (text != name) continue;
    *mode = value;
    return true;
  }
  return false;
}

inline std::ostream& operator<<(std::ostream& out, RotationMode mode) {
  return WriteMode(out, kRotationModes, mode);
}
inline std::ostream& operator<<(std::ostream& out, TranslationMode mode) {
  return WriteMode(out, kTranslationModes, mode);
}

}  // namespace vpslam

namespace YAML {

template <>
struct convert<vpslam::RotationMode> {
  static bool decode(const Node& node, vpslam::RotationMode& mode) {
    return vpslam::ReadMode(node, vpslam::kRotationModes, &mode);
  }
};

template <>
struct convert<vpslam::TranslationMode> {
  static bool decode(const Node& node, vpslam::TranslationMode& mode) {
    return vpslam::ReadMode(node, vpslam::kTranslationModes, &mode);
  }
};

}  // namespace YAML
