// The frontend's answer to one image.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/base/description.h"
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

  static constexpr const char* kWireName = "pose_t";
  static void Describe(auto& v, auto& m) {
    auto& [frame_seq, stamp_us, image_published_us, state, live, map, cam_from_world, reference,
           cam_from_reference, covariance, inliers, matches, keyframe, times] = m;
    using enum TrackingState;
    v("frame_seq", frame_seq, kNotNegative);
    v("stamp_us", stamp_us);
    v("image_published_us", image_published_us);
    v("state", state, OneOf<kInitialising, kTracking, kLost>());
    v("live", live);
    v("map_id", map);
    v("cam_from_world", cam_from_world);
    v("reference", reference);
    v("cam_from_reference", cam_from_reference);
    v("covariance", covariance);
    v("inliers", inliers, kNotNegative);
    v("matches", matches, kNotNegative);
    v("keyframe", keyframe);
    v("times", times);
  }
  std::optional<std::string> Validate() const {
    if (state == TrackingState::kTracking && !(map.IsValid() && reference.IsValid())) {
      return "a tracked pose needs a map and a reference keyframe";
    }
    return std::nullopt;
  }
};

}  // namespace vpslam
