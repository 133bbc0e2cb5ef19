// Finds out what kind of source a name stands for, and opens it.
#pragma once

#include <memory>
#include <string>

#include "player/image_source.h"

namespace vpslam {

/// Throws std::runtime_error with one line naming the fault and the remedy.
std::unique_ptr<ImageSource> OpenSource(const std::string& name, const SourceOptions& options);

}  // namespace vpslam
