// An image as the frontend sees it: what it showed, and where it is believed to stand.
#pragma once

#include <cstdint>
#include <memory>

#include "core/features/frame_observation.h"
#include "core/messages/stages.h"
#include "frontend/placement.h"

namespace vpslam {

/// Cheap to copy: what was seen is shared.
struct Frame {
  std::shared_ptr<const FrameObservation> seen;
  Placement placement;       ///< in no map until the frame is tracked
  int64_t published_us = 0;  ///< as ImageFrame::published_us
  TrackingTimes times;

  int64_t seq() const { return seen->frame_seq; }
  /// Forgets what was believed and begins anew in `map`, at this pose and without matches.
  void PlaceIn(MapId map, const SE3& cam_from_world) {
    placement = Placement(map, *seen, cam_from_world);
  }
};

}  // namespace vpslam
