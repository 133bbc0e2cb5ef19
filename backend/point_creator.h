// New points: unmatched features of a new keyframe, matched with those of its neighbours along
// epipolar lines, triangulated and checked.
#pragma once

#include <vector>

#include "backend/keyframe_store.h"
#include "backend/mapper_options.h"
#include "core/features/scale_levels.h"
#include "core/geometry/camera.h"
#include "core/map/map.h"

namespace vpslam {

/// Returns the points created, each with two observations.
std::vector<PointId> CreatePoints(KeyframeId keyframe, const Camera& camera,
                                  const ScalePyramid& scales, const KeyframeStore& store,
                                  const PointCreatorOptions& options, Map* map);

}  // namespace vpslam
