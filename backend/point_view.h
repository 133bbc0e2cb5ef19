// What is derived from a point's observations: viewing direction, range of distances, descriptor.
#pragma once

#include "backend/keyframe_store.h"
#include "core/features/scale_levels.h"
#include "core/map/map.h"

namespace vpslam {

/// Mean viewing direction, and the distance range from the octave in its reference keyframe.
void UpdateView(PointId point, const KeyframeStore& store, const ScalePyramid& scales, Map* map);

/// The descriptor with the least median distance to the point's others.
void UpdateDescriptor(PointId point, const KeyframeStore& store, Map* map);

}  // namespace vpslam
