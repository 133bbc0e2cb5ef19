// How far a run has come, as one line of JSON for the launcher.
#pragma once

#include <string>

#include "recorder/run_record.h"

namespace vpslam {

/// {"frame", "fps", "state", "keyframes", "points", "dropped", "processes": {name: state},
/// "messages": {name: what a running process has to tell people}}: the
/// newest frame with its map's counts; fps over the last second of image time on the wire; dropped
/// is what never got an answer, up to that frame.
/// `idle_s`: since the last pose came.
std::string ProgressLine(const RunRecord& run, double idle_s = 0);

}  // namespace vpslam
