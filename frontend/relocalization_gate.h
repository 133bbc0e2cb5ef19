// The motion gate of relocalization: whether a lost camera can have come to a place in the time
// since it was seen last.
//
// Places that look alike, such as the doors of a corridor, show many of each other's points, and
// PnP agrees with them. The way that the camera would have had to come tells them apart. The gate
// does not forbid a place, since a camera may be carried there in the dark: it asks for more
// evidence.
#pragma once

#include <cstdint>
#include <deque>

#include "core/map/map.h"
#include "frontend/frame.h"

namespace vpslam {

class RelocalizationGate {
 public:
  /// A frame that was tracked, in order of time.
  void See(const Frame& frame);
  /// The camera was found again: the way from where it was seen before says nothing of its speed.
  void Forget() { sightings_.clear(); }
  /// Whether the camera can have come to this pose in `map_id` until this time: at three times the
  /// speed that it had when it was seen last, or at the median depth of the scene per second, if
  /// that is more. True where nothing is known, because it was never seen or was seen in another
  /// map. A sighting does not count while the map does not have its keyframe yet.
  bool Allow(const Map& map, MapId map_id, const SE3& cam_from_world, int64_t stamp_us) const;

 private:
  struct Sighting {
    int64_t stamp_us;
    KeyframeId reference;
    SE3 cam_from_reference;
  };

  std::deque<Sighting> sightings_;  ///< of the last second
};

}  // namespace vpslam
