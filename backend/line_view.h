// What is derived from a map line's observations: its ends, its descriptor; and how keyframes see
// lines.
#pragma once

#include <optional>

#include "core/geometry/camera.h"
#include "core/geometry/line_triangulation.h"
#include "core/map/owned_map.h"

namespace vpslam {

/// The segment as seen from a camera at `cam_from_world`.
LineView ViewSegment(const LineSegment& segment, const SE3& cam_from_world, const Camera& camera);

/// The axis of the keyframe's Manhattan frame that the vanishing point of the segment is; -1 for
/// none.
int AxisOf(const LineSegment& segment, const LineSet& lines, const Keyframe& keyframe,
           const Map& map);

/// Direction in world of an axis of a Manhattan frame, which must exist.
Eigen::Vector3d AxisDirection(int axis, ManhattanId manhattan, const Map& map);

/// Moves the ends along the line to what the observations show of it.
void UpdateEnds(LineId line, const Camera& camera, OwnedMap* map);

/// The descriptor with the least median distance to the line's others.
void UpdateDescriptor(LineId line, OwnedMap* map);

/// Whether the observation fits the line as it is now (chi-square of both ends).
bool Fits(const MapLine& line, const SE3& cam_from_world, const LineSegment& segment,
          const Camera& camera);

/// Whether the line lies nearer to the camera than `min_depth`, as far as it was seen. What is much
/// nearer than all points is mostly no edge but segments of several, and moves in the image with
/// the slightest step of the camera, so that it outweighs all points in saying what that step was.
/// A line of an axis is let be: its direction does not depend on where it is.
bool IsTooNear(const MapLine& line, const SE3& cam_from_world, double min_depth);

}  // namespace vpslam
