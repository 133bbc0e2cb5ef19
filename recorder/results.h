// The results folder of a run.
//
//   trajectory.txt         every measured frame of the map with most of them, through the final
//                          keyframes; TUM format, camera-to-world
//   trajectory_map2.txt... the like of further maps
//   live_trajectory.txt    poses as published when their turn came
//   keyframes.txt          keyframes kept in the main map, TUM format
//   map.ply                its points and keyframes, and lines by their end points
//   frames.csv             a line per frame: state, inliers, ms per stage
//   keyframes.csv          a line per keyframe: ms per stage
//   summary.json           the figures of the run
#pragma once

#include <map>
#include <string>

#include "recorder/results_folder.h"
#include "recorder/run_record.h"
#include "recorder/summary.h"

namespace vpslam {

/// Contents by file name.
std::map<std::string, std::string> MakeResults(const RunRecord& run, const RunInfo& info);

/// Replaces the results in `folder`. Throws std::runtime_error with one line if it cannot.
void WriteResults(const RunRecord& run, const RunInfo& info, const ResultsFolder& folder);

}  // namespace vpslam
