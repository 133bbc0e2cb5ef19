// What a local bundle adjustment moves, and what it is measured from.
#pragma once

#include <set>

#include "backend/mapper_options.h"
#include "core/map/map.h"

namespace vpslam {

struct BaWindow {
  std::set<KeyframeId> moved;
  std::set<KeyframeId> fixed;
  std::set<PointId> points;
  std::set<LineId> lines;
};

/// The keyframe and those that share most with it, all that they see, and others that see it too.
BaWindow ChooseBaWindow(KeyframeId keyframe, const LocalBaOptions& options, const Map& map);

}  // namespace vpslam
