// How far away what a keyframe shows is: the measure of what is near, far, or a long way to go.
#pragma once

#include "core/map/map.h"

namespace vpslam {

/// Depth of the keyframe's points in its camera, map units; 0 if it has none.
double DepthQuantile(const Map& map, KeyframeId keyframe, double quantile);

}  // namespace vpslam
