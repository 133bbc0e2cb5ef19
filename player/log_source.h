// Plays a log of a run again: its images, or the features and lines that were found in them.
//
// Of all that a log holds, only what came from the source is used: CAMERA, TRUTH, and IMAGE or
// FEATURES. The rest is what the graph makes of it, and makes anew.
#pragma once

#include <memory>
#include <string>

#include "player/image_source.h"

namespace vpslam {

bool IsMessageLog(const std::string& name);

/// Reads the whole log once, so that what is wrong with it is known at the start. It plays images,
/// or features where the log has no images or options.features says so. Throws std::runtime_error.
std::unique_ptr<ImageSource> OpenMessageLog(const std::string& name, const SourceOptions& options);

}  // namespace vpslam
