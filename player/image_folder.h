// A plain folder of images, in natural order of their names and at a constant rate, which --fps or
// the calibration says; `camera.yaml` in the folder, or --camera. Of a folder with several series
// beside each other (left and right, images and masks; see image_series.h) one is played: that
// which is named, `folder/left*.png`, or the only one that is no depth, mask or the like.
#pragma once

#include <memory>
#include <string>

#include "player/image_source.h"

namespace vpslam {

/// True for a folder with at least one image, or a pattern that at least one has.
bool IsImageFolder(const std::string& path);

/// Throws std::runtime_error with one line naming file, fault and remedy.
std::unique_ptr<ImageSource> OpenImageFolder(const std::string& path, const SourceOptions& options);

}  // namespace vpslam
