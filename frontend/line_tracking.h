// Finding map lines in a frame.
#pragma once

#include <vector>

#include "frontend/frame.h"
#include "frontend/frame_tracking.h"
#include "frontend/tracker_options.h"

namespace vpslam {

/// Matches `lines` of the map, projected with frame->cam_from_world, with segments of the frame
/// that have no line yet; within `radius_factor` times the window. Returns how many.
int MatchLines(const TrackingContext& context, const std::vector<LineId>& lines,
               const LineTrackingOptions& options, double radius_factor, Frame* frame);

/// The living lines that a frame was matched with, or that a keyframe observes.
std::vector<LineId> LivingLines(const Map& map, const std::vector<LineId>& lines);

}  // namespace vpslam
