// What the rest of the graph is told of a frame.
#pragma once

#include "core/messages/frame_pose.h"
#include "frontend/frame.h"

namespace vpslam {

/// The report of a frame that has no place. `map`: the map in which the camera was lost; invalid if
/// there is none.
FramePose ReportUnplaced(const Frame& frame, TrackingState state, MapId map);
/// The report of a frame that was placed when it came.
FramePose ReportPlaced(const Frame& frame);
/// The report of a frame that was placed later.
FramePose ReportPlacedLate(const Frame& frame);

}  // namespace vpslam
