// New points: unmatched features of a new keyframe, matched with those of its neighbours along
// epipolar lines, triangulated and checked.
#pragma once

#include <vector>

#include "backend/mapper_options.h"
#include "backend/mapping_context.h"

namespace vpslam {

/// Returns the points created, each with two observations.
std::vector<PointId> CreatePoints(const MappingContext& context, KeyframeId keyframe,
                                  const PointCreatorOptions& options);

}  // namespace vpslam
