// Duplicates: the points of a new keyframe are looked for in its neighbours, and theirs in it; a
// feature found free gains an observation, one that has another point gets the two fused.
#pragma once

#include "backend/keyframe_store.h"
#include "backend/mapper_options.h"
#include "core/features/scale_levels.h"
#include "core/geometry/camera.h"
#include "core/map/map.h"

namespace vpslam {

void FusePoints(KeyframeId keyframe, const Camera& camera, const Camera::Bounds& bounds,
                const ScalePyramid& scales, const KeyframeStore& store,
                const PointFuserOptions& options, Map* map);

}  // namespace vpslam
