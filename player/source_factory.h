// Finds out what kind of source a name stands for, and opens it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "player/image_source.h"

namespace vpslam {

/// `options.kind` overrides what the name and what is found there look like. Throws
/// std::runtime_error with one line naming the fault and the remedy.
std::unique_ptr<ImageSource> OpenSource(const std::string& name, const SourceOptions& options);

/// What `options.kind` may be.
std::vector<std::string> SourceKindNames();

}  // namespace vpslam
