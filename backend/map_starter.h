// The first two keyframes and points of a map, from two-view initialisation.
#pragma once

#include <vector>

#include "backend/keyframe_store.h"
#include "backend/mapper_options.h"
#include "core/features/scale_levels.h"
#include "core/geometry/camera.h"
#include "core/map/map.h"
#include "core/messages/keyframe_proposal.h"

namespace vpslam {

/// Inserts both keyframes and the points, and adjusts them. The unit of length is the one that the
/// frontend chose. Returns the points.
std::vector<PointId> StartMap(const KeyframeProposal& first, const KeyframeProposal& second,
                              const Camera& camera, const ScalePyramid& scales,
                              const KeyframeStore& store, const LocalBaOptions& options, Map* map);

}  // namespace vpslam
