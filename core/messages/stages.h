// Time spent per stage of the work on one frame or keyframe, in ms; NaN where a stage did not run.
#pragma once

#include "core/base/stopwatch.h"

namespace vpslam {

/// The columns of frames.csv.
struct TrackingTimes {
  double decode_ms = kNotRun;     ///< reading and decoding the image file
  double transport_ms = kNotRun;  ///< image published to image taken up
  double features_ms = kNotRun;
  double lines_ms = kNotRun;
  double vps_ms = kNotRun;
  double wait_for_lines_ms = kNotRun;
  double initial_pose_ms =
      kNotRun;  ///< motion model or reference keyframe; initialiser; relocaliser
  double rotation_ms = kNotRun;
  double translation_ms = kNotRun;
  double local_map_ms = kNotRun;
  double total_ms = kNotRun;  ///< image published to pose published
};

/// The columns of keyframes.csv.
struct MappingTimes {
  double insertion_ms = kNotRun;
  double feature_culling_ms = kNotRun;
  double feature_creation_ms = kNotRun;
  double keyframe_culling_ms = kNotRun;
  double local_ba_ms = kNotRun;
  double total_ms = kNotRun;
};

}  // namespace vpslam
