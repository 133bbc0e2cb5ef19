// Finds a lost frame in the map, without any idea of where it might be: features against the points
// of keyframes, PnP, and then the local map.
#pragma once

#include <random>

#include "frontend/frame.h"
#include "frontend/frame_tracking.h"
#include "frontend/tracker_options.h"

namespace vpslam {

struct RelocalizerOptions {
  int min_matches = 15;    ///< between frame and keyframe
  int max_candidates = 5;  ///< keyframes that are tried, those with most matches first
};

/// On success the frame has its pose and its matches.
bool Relocalize(const TrackingContext& context, MapId map, const RelocalizerOptions& options,
                const TrackerOptions& tracking, std::mt19937_64& rng, Frame* frame);

}  // namespace vpslam
