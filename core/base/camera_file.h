// Camera calibration as a flat YAML file: width, height, fx, fy, cx, cy; optional fps and k1, k2,
// p1, p2, k3, and mask (a picture of that size, beside the file: black where images are not to be
// used). Other keys are refused by name: one that is misspelt, or belongs to a lens that is not
// modelled, would change the camera in silence.
#pragma once

#include <string>

#include "core/geometry/camera.h"

namespace vpslam {

/// Reads and validates `path`. Throws std::runtime_error with one line naming file, fault and
/// remedy.
Camera ReadCameraFile(const std::string& path);

}  // namespace vpslam
