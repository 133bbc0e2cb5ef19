// When a frame becomes a keyframe.
#pragma once

#include "core/map/map.h"
#include "frontend/frame.h"
#include "frontend/tracker_options.h"

namespace vpslam {

/// `frames_since`: frames since the last keyframe. `reference`: the keyframe that shares most
/// points with the frame.
bool IsKeyframe(const Frame& frame, KeyframeId reference, int frames_since, const Map& map,
                const KeyframePolicyOptions& options);

}  // namespace vpslam
