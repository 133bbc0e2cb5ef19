// What of a map a delta has to tell.
#pragma once

#include <set>
#include <vector>

#include "core/base/ids.h"

namespace vpslam {

struct MapChanges {
  std::set<MapId> erased_maps;
  std::set<MapId> merged_maps;  ///< that have become part of another
  std::set<KeyframeId> keyframes;
  std::set<PointId> appearances;
  std::set<PointId> geometries;
  std::set<PointId> tombstones;
  std::set<LineId> lines;
  std::set<LineId> line_tombstones;
  std::set<ManhattanId> manhattan_frames;
  std::vector<PointId> forgotten_points;
  std::vector<LineId> forgotten_lines;
};

}  // namespace vpslam
