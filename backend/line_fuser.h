// Map lines that neighbours know are looked for in a keyframe, and its own in theirs; lines that
// turn out to be one are fused.
#pragma once

#include "backend/mapper_options.h"
#include "backend/mapping_context.h"

namespace vpslam {

void FuseLines(const MappingContext& context, KeyframeId keyframe,
               const LineMappingOptions& options);

}  // namespace vpslam
