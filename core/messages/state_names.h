// States as words, for tables, JSON and the progress line.
#pragma once

#include "core/messages/frame_pose.h"
#include "core/messages/process_status.h"

namespace vpslam {

inline const char* StateName(TrackingState state) {
  switch (state) {
    case TrackingState::kInitialising:
      return "initialising";
    case TrackingState::kTracking:
      return "tracking";
    case TrackingState::kLost:
      return "lost";
  }
  return "unknown";
}

inline const char* StateName(ProcessState state) {
  switch (state) {
    case ProcessState::kStarting:
      return "starting";
    case ProcessState::kReady:
      return "ready";
    case ProcessState::kRunning:
      return "running";
    case ProcessState::kFinished:
      return "finished";
    case ProcessState::kFailed:
      return "failed";
  }
  return "unknown";
}

}  // namespace vpslam
