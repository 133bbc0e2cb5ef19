// From a proposal to a keyframe of the map.
#pragma once

#include "core/geometry/camera.h"
#include "core/map/keyframe.h"
#include "core/messages/keyframe_proposal.h"

namespace vpslam {

/// With what was seen and where, and without observations. `bounds`: of undistorted key points.
Keyframe ToKeyframe(const KeyframeProposal& proposal, KeyframeId parent,
                    const Camera::Bounds& bounds);

}  // namespace vpslam
