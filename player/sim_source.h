// The simulator as a source: sim:room, sim:corridor, with keys as player/simulator/spec.h says.
#pragma once

#include <memory>
#include <string>

#include "player/image_source.h"

namespace vpslam {

bool IsSimulation(const std::string& name);

/// Throws std::runtime_error with one line naming fault and remedy.
std::unique_ptr<ImageSource> OpenSimulation(const std::string& name, const SourceOptions& options);

}  // namespace vpslam
