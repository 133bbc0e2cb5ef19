// A scene together with the way a camera is carried through it.
#pragma once

#include <cstdint>
#include <functional>

#include "player/simulator/scene.h"
#include "player/simulator/trajectory.h"

namespace vpslam::simulator {

struct Place {
  Scene scene;
  std::function<Waypoint(int)> waypoint;  ///< see Trajectory
  double knot_s = 1;
  HandOptions hand;
  double exposure_s = 0.01;
};

/// A furnished living room, about 5.2 x 4.4 m. The camera circles the table, looking across it,
/// once in about 18 s; every round differs a little.
Place MakeRoom(uint64_t seed);

/// An office corridor with bare walls and a turn to the left. The camera walks to its end and back.
Place MakeCorridor(uint64_t seed);

}  // namespace vpslam::simulator
