// Finding map lines in a frame.
#pragma once

#include <vector>

#include "frontend/frame.h"
#include "frontend/frame_tracking.h"
#include "frontend/tracker_options.h"

namespace vpslam {

/// Matches `lines` of the map, projected with the frame's pose, with segments of the frame
/// that have no line yet. A segment lies at most `window_px` away from where its line is predicted.
/// Returns how many were matched.
int MatchLines(const TrackingContext& context, const std::vector<LineId>& lines, double window_px,
               const LineTrackingOptions& options, Frame* frame);

/// The living lines that a frame was matched with, or that a keyframe observes.
std::vector<LineId> LivingLines(const Map& map, const std::vector<LineId>& lines);

}  // namespace vpslam
