// Duplicates: the points of a new keyframe are looked for in its neighbours, and theirs in it; a
// feature found free gains an observation, one that has another point gets the two fused.
#pragma once

#include "backend/mapper_options.h"
#include "backend/mapping_context.h"

namespace vpslam {

void FusePoints(const MappingContext& context, KeyframeId keyframe,
                const PointFuserOptions& options);

}  // namespace vpslam
