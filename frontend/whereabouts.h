// Where a lost camera can be by now: as far from where it was seen last as it may have moved since.
//
// A place that looks like another one, as doors of a corridor do, shows many of the other's
// points, and PnP agrees with them. What tells the two apart is that the camera can't have come
// there in the time; a camera that was carried there in the dark finds itself by more evidence.
#pragma once

#include <cstdint>
#include <deque>

#include "core/map/map.h"
#include "frontend/frame.h"

namespace vpslam {

class Whereabouts {
 public:
  /// A frame that was tracked, in order of time.
  void See(const Frame& frame);
  /// The camera was found: how it came there says nothing of its speed.
  void Forget() { sightings_.clear(); }
  /// Whether a camera that has this pose in `map_id` at this time fits to where it was seen last:
  /// at no more than three times the speed that it had, or the median depth of the scene in a
  /// second, if that is more. True where nothing is known: never seen, or seen in another map. A
  /// sighting whose keyframe the map has not got yet does not count.
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
