// Calibrations that can be read but cannot be those of a camera: focal lengths in mm, or as shares
// of the width; a distortion that was fitted to something else.
#pragma once

#include <optional>
#include <string>

#include "core/geometry/camera.h"

namespace vpslam {

/// Why no lens that the model describes is like that; nullopt if one may be. For a camera that is
/// valid (Camera::Validate).
std::optional<std::string> WhyImplausible(const Camera& camera);

/// Throws std::runtime_error, with the name of the calibration and the remedy, if the camera is not
/// valid or not plausible.
void RequirePlausible(const Camera& camera, const std::string& name);

/// The share of the image, 0 to 1, of which the model knows what it shows: where a polynomial of
/// distortion folds over, it does not.
double UsableShare(const Camera& camera);

}  // namespace vpslam
