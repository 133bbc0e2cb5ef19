// The frontend's answer to one image.
#pragma once

#include <cstdint>

#include "core/base/ids.h"
#include "core/geometry/se3.h"
#include "core/messages/stages.h"

namespace vpslam {

enum class TrackingState : int32_t {
  kInitialising = 0,  ///< no map yet
  kTracking = 1,      ///< the pose is measured
  kLost = 2,          ///< there is a map, but the frame could not be placed in it
};

struct FramePose {
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  int64_t image_published_us = 0;  ///< CLOCK_MONOTONIC, from the image
  TrackingState state = TrackingState::kInitialising;
  /// False for a pose found later than its turn (tracked backwards once the map stood): it belongs
  /// to the trajectory but was never known live. A later pose of a frame replaces an earlier one.
  bool live = true;
  MapId map;
  /// Pose and what it hangs on; meaningful in kTracking only.
  SE3 cam_from_world;
  KeyframeId reference;
  /// Survives corrections of the map: express the pose through this. Its unit of length is the one
  /// that the reference was made in (see Map::Place).
  SE3 cam_from_reference;
  Matrix6d covariance = Matrix6d::Zero();  ///< of the left perturbation (rho, phi)
  int32_t inliers = 0;
  int32_t matches = 0;
  KeyframeId keyframe;  ///< the keyframe that this frame became; invalid if none
  TrackingTimes times;
};

}  // namespace vpslam
