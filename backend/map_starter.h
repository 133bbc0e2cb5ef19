// The first two keyframes and points of a map, from two-view initialisation.
#pragma once

#include <vector>

#include "backend/mapper_options.h"
#include "backend/mapping_context.h"
#include "core/features/scale_levels.h"
#include "core/geometry/camera.h"
#include "core/map/map.h"
#include "core/messages/keyframe_proposal.h"

namespace vpslam {

/// Inserts both keyframes and the points, and adjusts them. The unit of length is the one that the
/// frontend chose. Returns the points.
std::vector<PointId> StartMap(const MappingContext& context, const KeyframeProposal& first,
                              const KeyframeProposal& second, const LocalBaOptions& options);

}  // namespace vpslam
