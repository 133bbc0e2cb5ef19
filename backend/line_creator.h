// New map lines: segments of a keyframe that show no line yet are matched with those of its
// neighbours and triangulated.
//
// Two planes always meet in a line, so two views cannot tell a wrong match. A line is created where
// a third keyframe shows it too, or where both segments are of the same axis of the Manhattan
// frame, or, in a map of two views, of the same vanishing point, and a line with that direction
// fits both (VP-directed triangulation).
#pragma once

#include <vector>

#include "backend/mapper_options.h"
#include "backend/mapping_context.h"

namespace vpslam {

/// Returns the lines created, each with two or more observations.
std::vector<LineId> CreateLines(const MappingContext& context, KeyframeId keyframe,
                                const LineMappingOptions& options);

}  // namespace vpslam
