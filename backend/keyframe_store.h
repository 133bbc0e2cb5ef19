// What the backend keeps of each keyframe beside the map itself: its features and lines.
#pragma once

#include <map>

#include "core/base/ids.h"
#include "core/features/feature_grid.h"
#include "core/features/features.h"
#include "core/features/line_set.h"

namespace vpslam {

struct KeyframeFeatures {
  Features features;
  FeatureGrid grid;
  LineSet lines;
};

using KeyframeStore = std::map<KeyframeId, KeyframeFeatures>;

}  // namespace vpslam
