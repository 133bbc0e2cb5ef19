// States as words, for tables and the progress line.
#pragma once

#include "core/messages/frame_pose.h"
#include "core/messages/process_status.h"

namespace vpslam {

const char* StateName(TrackingState state);
const char* StateName(ProcessState state);

}  // namespace vpslam
