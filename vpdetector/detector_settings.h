// The detector's two enumerations as settings: by name, in a file, on the command line, in the log.
#pragma once

#include <ostream>

#include <yaml-cpp/yaml.h>

#include "vpdetector/line_detector.h"
#include "vpdetector/vp_estimator.h"

namespace vpslam {

inline std::ostream& operator<<(std::ostream& out, LineDetectorKind kind) {
  return out << Name(kind);
}
inline std::ostream& operator<<(std::ostream& out, VpMethod method) { return out << Name(method); }

}  // namespace vpslam

namespace YAML {

template <>
struct convert<vpslam::LineDetectorKind> {
  static bool decode(const Node& node, vpslam::LineDetectorKind& kind) {
    const auto named = vpslam::LineDetectorKindFromName(node.as<std::string>());
    if (named) kind = *named;
    return named.has_value();
  }
};

template <>
struct convert<vpslam::VpMethod> {
  static bool decode(const Node& node, vpslam::VpMethod& method) {
    const auto named = vpslam::VpMethodFromName(node.as<std::string>());
    if (named) method = *named;
    return named.has_value();
  }
};

}  // namespace YAML
