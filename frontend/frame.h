// An image as the frontend sees it: features, what they were matched with, and where it stands.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/ids.h"
#include "core/features/feature_grid.h"
#include "core/features/features.h"
#include "core/features/line_set.h"
#include "core/geometry/se3.h"
#include "core/messages/stages.h"

namespace vpslam {

struct Frame {
  int64_t seq = 0;
  int64_t stamp_us = 0;
  int64_t published_us = 0;
  Features features;
  FeatureGrid grid;
  std::vector<PointId> points;           ///< per feature; invalid where none is matched
  std::shared_ptr<const LineSet> lines;  ///< nullptr without a detector
  std::vector<LineId> map_lines;         ///< per line; invalid where none is matched
  SE3 cam_from_world;
  Matrix6d covariance = Matrix6d::Zero();
  KeyframeId reference;    ///< what the pose hangs on when the map is corrected
  SE3 cam_from_reference;  ///< see Map::Place
  double unit = 1;         ///< of the reference, when cam_from_world was set
  int inliers = 0;         ///< points
  int line_inliers = 0;
  int matches = 0;
  TrackingTimes times;

  /// What the pose rests on.
  int Support() const { return inliers + line_inliers; }
  void ForgetMatches() {
    points.assign(features.keypoints.size(), PointId());
    map_lines.assign(lines ? lines->lines.size() : 0, LineId());
    inliers = line_inliers = 0;
  }
};

}  // namespace vpslam
