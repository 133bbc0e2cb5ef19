// What every step of mapping works on.
#pragma once

#include "core/features/scale_levels.h"
#include "core/geometry/camera.h"
#include "core/map/owned_map.h"

namespace vpslam {

struct MappingContext {
  const Camera& camera;
  const Camera::Bounds& bounds;  ///< of undistorted key points
  const ScalePyramid& scales;
  OwnedMap& map;
};

}  // namespace vpslam
