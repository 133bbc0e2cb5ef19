// Keyframes of the map: what they saw (shared, never changed) and what is believed of them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/base/ids.h"
#include "core/features/frame_observation.h"
#include "core/geometry/se3.h"

namespace vpslam {

/// What stays of a keyframe when it is culled: its place in the spanning tree. Poses of frames hang
/// on it.
struct KeyframeNode {
  KeyframeId id;
  MapId map;
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  bool culled = false;
  KeyframeId parent;    ///< invalid for the first keyframe of a map
  SE3 cam_from_parent;  ///< of a culled one, fixed at culling
  /// Lengths now per lengths when the keyframe was made: maps that are merged change their unit.
  double unit = 1;
};

/// How many landmarks two keyframes share.
struct Covisibility {
  KeyframeId keyframe;
  int32_t shared = 0;

  bool operator==(const Covisibility&) const = default;
};

struct Keyframe : KeyframeNode {
  SE3 cam_from_world;
  std::vector<PointId> points;  ///< per feature; invalid where it observes none
  std::vector<LineId> lines;    ///< per line segment; invalid where it observes none
  ManhattanId manhattan;        ///< the frame whose axes it sees; invalid for none
  /// nullptr in replicas: features stay with the owner.
  std::shared_ptr<const FrameObservation> seen;
  /// Kept by Map: all keyframes with which it shares a point or a line, by ascending id.
  std::vector<Covisibility> covisible;

  Eigen::Vector3d Center() const { return cam_from_world.Center(); }
};

}  // namespace vpslam
