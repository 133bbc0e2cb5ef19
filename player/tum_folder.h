// The folder layout of the TUM RGB-D benchmark [Sturm, Engelhard, Endres, Burgard, Cremers, IROS
// 2012]: `rgb.txt` with lines `seconds file`, optionally `groundtruth.txt` with lines
// `seconds tx ty tz qx qy qz qw` (camera-to-world, m), '#' for comments; besides, `camera.yaml`.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "player/image_list.h"
#include "player/image_source.h"

namespace vpslam {

bool IsTumFolder(const std::string& path);

/// Throws std::runtime_error with one line naming file, fault and remedy.
std::unique_ptr<ImageSource> OpenTumFolder(const std::string& path, const SourceOptions& options);

/// Images and truth of such a folder; the camera of `list` is left alone.
void ReadTumLists(const std::filesystem::path& folder, ImageList* list);

}  // namespace vpslam
