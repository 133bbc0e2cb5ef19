// The part of the map around a frame: keyframes that share its points, their neighbours, and all
// points these see. [Mur15] sec. V-D.
#pragma once

#include <vector>

#include "core/map/map.h"
#include "frontend/frame.h"
#include "frontend/frame_tracking.h"
#include "frontend/tracker_options.h"

namespace vpslam {

struct LocalMap {
  KeyframeId reference;  ///< the keyframe that shares most points and lines with the frame
  std::vector<KeyframeId> keyframes;
  std::vector<PointId> points;  ///< ascending
  std::vector<LineId> lines;    ///< ascending
};

/// Around the points and lines that the frame is matched with.
LocalMap CollectLocalMap(const Map& map, const Frame& frame, const LocalMapOptions& options);

/// Projects the local points with the frame's pose and matches those that it does not have yet.
/// `visible` receives all points that should be seen, matched before or not. Returns the number of
/// new matches.
int MatchLocalMap(const TrackingContext& context, const LocalMap& local,
                  const LocalMapOptions& options, double radius_factor, Frame* frame,
                  std::vector<PointId>* visible);

}  // namespace vpslam
