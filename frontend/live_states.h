// The states of tracking, each with what it alone needs.
//
//   Starting -> OnProbation -> Tracking <-> Lost
//
// Starting     There is no map. Each image is tried as the second view of one.
// OnProbation  A map was started and may be wrong. When it has grown enough the state is Tracking.
// If
//              the camera is lost before, the map is given up, and the state is the one before:
//              Starting, or Lost where there are other maps.
// Tracking     The last image has a place in a map.
// Lost         The last image has none. Each image is looked for in all maps; after a while each is
//              also tried as the second view of a new map, which is on probation then.
#pragma once

#include <cstdint>
#include <optional>
#include <utility>
#include <variant>

#include "core/base/ids.h"
#include "core/geometry/se3.h"
#include "frontend/frame.h"
#include "frontend/frame_buffers.h"
#include "frontend/initializer.h"

namespace vpslam {

/// The last image, and how the camera came there.
struct Motion {
  Frame last;
  std::optional<SE3> velocity;  ///< last camera from the one before; none right after a jump

  /// The next image was placed.
  void Advance(Frame frame) {
    velocity = frame.placement.cam_from_world * last.placement.cam_from_world.Inverse();
    last = std::move(frame);
  }
};

struct Starting {
  Initializer initializer;
  PendingFrames pending;  ///< all images so far
};

struct OnProbation {
  Motion motion;
  RecentFrames recent;     ///< before motion.last
  Frame first;             ///< that became the map's first keyframe
  int64_t second_seq = 0;  ///< of the frame that became its second one
  PendingFrames pending;   ///< to be placed in the map: images from before its start, and since
  int frames_lost = 0;     ///< Lost::frames_lost when the map was started
};

struct Tracking {
  Motion motion;
  RecentFrames recent;  ///< before motion.last
};

struct Lost {
  Initializer initializer;
  MapId map;              ///< in which the camera was lost
  int frames_lost = 0;    ///< so far; not counted any more once a new map is tried
  PendingFrames pending;  ///< all images since
};

using LiveState = std::variant<Starting, OnProbation, Tracking, Lost>;

}  // namespace vpslam
