// What is believed of a frame in one map.
#pragma once

#include <cstdint>
#include <vector>

#include "core/features/frame_observation.h"
#include "core/geometry/se3.h"
#include "core/map/map.h"

namespace vpslam {

/// Where a frame stands in one map, and which points and lines of that map it shows.
///
/// The map and the matches are private, so that matches with two maps cannot be mixed: a landmark
/// of another map is refused, and matching in another map begins with a new placement.
class Placement {
 public:
  /// In no map: without matches, and it takes none.
  Placement() = default;
  /// At this pose (`cam_from_world`) in `map`, without matches yet.
  Placement(MapId map, const FrameObservation& seen, const SE3& pose)
      : cam_from_world(pose),
        map_(map),
        points_(seen.num_features()),
        lines_(seen.num_segments()) {}

  MapId map() const { return map_; }
  /// Per feature the point that it shows; invalid where none is matched. Empty in no map.
  const std::vector<PointId>& points() const { return points_; }
  /// Per line segment the line that it shows; invalid where none is matched. Empty in no map.
  const std::vector<LineId>& lines() const { return lines_; }

  /// The feature, or the segment, shows this. Returns false, and does nothing, where that belongs
  /// to another map.
  bool Match(int feature, const MapPoint& point);
  bool Match(int segment, const MapLine& line);
  void UnmatchPoint(int feature) { points_[feature] = PointId(); }
  void UnmatchLine(int segment) { lines_[segment] = LineId(); }

  /// Lets the pose hang on `keyframe` of the map: `reference`, `cam_from_reference` and `unit`.
  /// False if the map does not have that keyframe.
  bool HangOn(const Map& map, KeyframeId keyframe);
  /// The frame was proposed as keyframe `id`: its pose hangs on that from now on.
  void BecomeKeyframe(KeyframeId id);
  /// To be called when the map may have changed. The pose moves with the keyframe that it hangs on.
  /// If the frame (which showed `seen`) is that keyframe, it takes over the keyframe's matches.
  /// `velocity` (from camera to camera, may be nullptr) is brought to the map's present unit of
  /// length. False if the map does not have that keyframe: then only map() is brought up to date.
  bool Follow(const Map& map, const FrameObservation& seen, SE3* velocity);

  /// What the pose rests on.
  int Support() const { return inliers + line_inliers; }

  SE3 cam_from_world;
  Matrix6d covariance = Matrix6d::Zero();  ///< of the left perturbation (rho, phi)
  KeyframeId reference;                    ///< what the pose hangs on when the map is corrected
  SE3 cam_from_reference;                  ///< see Map::Place
  double unit = 1;                         ///< of the reference, when cam_from_world was set
  int num_matches = 0;                     ///< points, before the pose was optimised
  int inliers = 0;                         ///< points
  int line_inliers = 0;

 private:
  MapId map_;
  std::vector<PointId> points_;
  std::vector<LineId> lines_;
};

}  // namespace vpslam
