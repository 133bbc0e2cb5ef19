// A video file, through OpenCV (FFmpeg). Time stamps are the file's own; with --fps, or where the
// file has none that increase, frames come at a constant rate. The calibration is named by
// --camera.
#pragma once

#include <memory>
#include <string>

#include "player/image_source.h"

namespace vpslam {

/// True for any file: which ones are videos, FFmpeg knows.
bool IsVideoFile(const std::string& path);

/// Throws std::runtime_error with one line naming file, fault and remedy.
std::unique_ptr<ImageSource> OpenVideoFile(const std::string& path, const SourceOptions& options);

}  // namespace vpslam
