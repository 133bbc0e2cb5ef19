// The trajectories that a run leaves behind, and their text.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/ids.h"
#include "core/geometry/se3.h"
#include "recorder/run_record.h"

namespace vpslam {

struct StampedPose {
  int64_t stamp_us = 0;
  SE3 world_from_cam;
};

struct MapTrajectory {
  MapId map;
  std::vector<StampedPose> poses;  ///< by frame
};

/// Whether the frame has a pose in one of the trajectories.
bool HasFinalPose(const RunRecord& run, const FramePose& pose);

/// Every measured frame of each map, placed by where its reference keyframe is now:
/// world_from_cam = (cam_from_reference * reference_from_world)^-1 (see Map::Place). The map with
/// most frames comes first, ties by id; a frame belongs to the map in which its reference keyframe
/// is now. Maps without a measured frame, and frames of erased maps, are not there.
std::vector<MapTrajectory> FinalTrajectories(const RunRecord& run);

/// The measured poses as they were published when their turn came.
std::vector<StampedPose> LiveTrajectory(const RunRecord& run);

/// The map that the results are about: that of most measured frames; if there are none, that of
/// most keyframes; invalid if there is no map.
MapId MainMap(const RunRecord& run);

/// The keyframes of `map` that were not culled, by id.
std::vector<StampedPose> KeyframeTrajectory(const Map& map, MapId map_id);

/// Lines of the TUM format, `seconds tx ty tz qx qy qz qw`, with qw >= 0. The same numbers always
/// give the same bytes.
std::string FormatTum(const std::vector<StampedPose>& poses);

/// Microseconds as seconds with six decimals, exactly.
std::string FormatStamp(int64_t stamp_us);

}  // namespace vpslam
