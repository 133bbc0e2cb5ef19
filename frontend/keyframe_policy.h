// When a frame becomes a keyframe, and what of it the backend is told then.
#pragma once

#include "core/map/map.h"
#include "core/messages/keyframe_proposal.h"
#include "frontend/frame.h"
#include "frontend/tracker_options.h"

namespace vpslam {

/// The keyframes that were proposed before.
struct EarlierKeyframes {
  int frames_since = 0;  ///< frames since the last one
  int unanswered = 0;    ///< how many of them the map does not have yet; 0 in lockstep
};

/// Whether the frame shows so little of the map that the camera is soon lost without new points.
bool IsWeaklyTracked(const Frame& frame, KeyframeId reference, const Map& map,
                     const KeyframePolicyOptions& options);

/// Whether the frame should become a keyframe. `reference`: the keyframe that shares most points
/// and lines with the frame.
bool IsKeyframe(const Frame& frame, KeyframeId reference, const EarlierKeyframes& earlier,
                const Map& map, const KeyframePolicyOptions& options);

/// The frame as keyframe `id` of the map in which it is placed.
KeyframeProposal MakeProposal(const Frame& frame, KeyframeId id);

}  // namespace vpslam
