// What keyframes see: points and lines of the map.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/base/ids.h"
#include "core/features/features.h"

namespace vpslam {

struct Observation {
  KeyframeId keyframe;
  int32_t feature = 0;  ///< of the keyframe's features, or of its line segments

  bool operator==(const Observation&) const = default;
};

/// What points and lines have in common.
template <class Id>
struct Landmark {
  Id id;
  MapId map;
  KeyframeId reference;                   ///< the keyframe that created it
  std::vector<Observation> observations;  ///< by ascending keyframe
};

struct MapPoint : Landmark<PointId> {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< in world
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< mean unit vector from point to cameras
  double max_distance = 0;  ///< farthest distance from which level 0 can show it
  Descriptor descriptor{};
};

/// An infinite line, and how much of it was seen. From start to end it runs as its segments do, see
/// core/features/line_set.h.
struct MapLine : Landmark<LineId> {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  ///< in world
  Eigen::Vector3d end = Eigen::Vector3d::Zero();
  Descriptor descriptor{};
  ManhattanId manhattan;  ///< the frame that has the axis; invalid for none
  int32_t axis = -1;      ///< of that frame, to which the line is parallel; -1 for none

  Eigen::Vector3d Direction() const { return (end - start).normalized(); }
};

}  // namespace vpslam
