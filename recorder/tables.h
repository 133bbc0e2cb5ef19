// frames.csv and keyframes.csv.
#pragma once

#include <string>

#include "recorder/run_record.h"

namespace vpslam {

/// A line per frame that the frontend answered: state and inliers as they hold in the end, times as
/// they were when its turn came. What did not run is an empty cell.
std::string FramesTable(const RunRecord& run);

/// A line per keyframe that the backend answered.
std::string KeyframesTable(const RunRecord& run);

}  // namespace vpslam
