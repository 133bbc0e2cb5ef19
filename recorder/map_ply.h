// One map as points and lines that any viewer opens.
#pragma once

#include <string>

#include "core/map/map.h"

namespace vpslam {

/// ASCII PLY, in world coordinates: points in grey, centres of the kept keyframes in red,
/// ends of lines in blue, with an edge between them.
std::string MapPly(const Map& map, MapId map_id);

}  // namespace vpslam
