// Time spent per stage of the work on one frame or keyframe, in ms; NaN where a stage did not run.
#pragma once

#include "core/base/description.h"
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

  static constexpr const char* kWireName = "tracking_times_t";
  static void Describe(auto& v, auto& m) {
    auto& [decode_ms, transport_ms, features_ms, lines_ms, vps_ms, wait_for_lines_ms,
           initial_pose_ms, rotation_ms, translation_ms, local_map_ms, total_ms] = m;
    v("decode_ms", decode_ms, Duration());
    v("transport_ms", transport_ms, Duration());
    v("features_ms", features_ms, Duration());
    v("lines_ms", lines_ms, Duration());
    v("vps_ms", vps_ms, Duration());
    v("wait_for_lines_ms", wait_for_lines_ms, Duration());
    v("initial_pose_ms", initial_pose_ms, Duration());
    v("rotation_ms", rotation_ms, Duration());
    v("translation_ms", translation_ms, Duration());
    v("local_map_ms", local_map_ms, Duration());
    v("total_ms", total_ms, Duration());
  }
};

/// The columns of keyframes.csv.
struct MappingTimes {
  double insertion_ms = kNotRun;
  double feature_culling_ms = kNotRun;
  double feature_creation_ms = kNotRun;
  double keyframe_culling_ms = kNotRun;
  double local_ba_ms = kNotRun;
  double total_ms = kNotRun;

  static constexpr const char* kWireName = "mapping_times_t";
  static void Describe(auto& v, auto& m) {
    auto& [insertion_ms, feature_culling_ms, feature_creation_ms, keyframe_culling_ms, local_ba_ms,
           total_ms] = m;
    v("insertion_ms", insertion_ms, Duration());
    v("feature_culling_ms", feature_culling_ms, Duration());
    v("feature_creation_ms", feature_creation_ms, Duration());
    v("keyframe_culling_ms", keyframe_culling_ms, Duration());
    v("local_ba_ms", local_ba_ms, Duration());
    v("total_ms", total_ms, Duration());
  }
};

}  // namespace vpslam
