// Map lines that neighbours know are looked for in a keyframe, and its own in theirs; lines that
// turn out to be one are fused.
#pragma once

#include "backend/keyframe_store.h"
#include "backend/mapper_options.h"
#include "core/geometry/camera.h"
#include "core/map/map.h"

namespace vpslam {

void FuseLines(KeyframeId keyframe, const Camera& camera, const Camera::Bounds& bounds,
               const KeyframeStore& store, const LineMappingOptions& options, Map* map);

}  // namespace vpslam
