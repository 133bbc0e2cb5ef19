// What is derived from a point's observations: viewing direction, range of distances, descriptor.
#pragma once

#include "core/features/scale_levels.h"
#include "core/map/owned_map.h"

namespace vpslam {

/// Mean viewing direction, and the distance range from the octave in its reference keyframe.
void UpdateView(PointId point, const ScalePyramid& scales, OwnedMap* map);

/// The descriptor with the least median distance to the point's others.
void UpdateDescriptor(PointId point, OwnedMap* map);

}  // namespace vpslam
