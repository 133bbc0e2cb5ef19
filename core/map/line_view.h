// Where a map line should appear in a view.
#pragma once

#include <optional>

#include "core/features/line_matcher.h"
#include "core/geometry/camera.h"
#include "core/geometry/se3.h"
#include "core/map/map.h"

namespace vpslam {

/// The visible part of the line between its end points, clipped at a plane before the camera and at
/// `bounds`; nullopt if less than `min_length_px` of it is to be seen.
std::optional<ImageSegment> PredictSegment(const MapLine& line, const SE3& cam_from_world,
                                           const Camera& camera, const Camera::Bounds& bounds,
                                           double min_length_px = 20);

}  // namespace vpslam
