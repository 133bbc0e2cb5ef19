// A 3D line from the segments that show it in several views.
//
// Each segment spans a plane with its camera's centre; the line lies in all of them. Two planes
// that are nearly the same one (the line lies in the epipolar plane of two views, or the cameras
// stand close together) say nothing about depth. Where vanishing points tell the direction, planes
// need to fix the position only.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

namespace vpslam {

/// A segment as seen from its camera, in world coordinates.
struct LineView {
  Eigen::Vector3d center;     ///< of the camera
  Eigen::Vector3d start_ray;  ///< through the segment's end points; unit
  Eigen::Vector3d end_ray;

  Eigen::Vector3d Normal() const { return start_ray.cross(end_ray).normalized(); }
};

/// What of the line the first view's segment shows; the direction is end - start.
struct TriangulatedLine {
  Eigen::Vector3d start, end;
};

struct LineTriangulationOptions {
  /// Between a ray of the first view and the plane of the second: less says nothing about depth.
  double min_ray_plane_angle_rad = 0.02;
};

/// Intersects the plane of `b` with the rays of `a`. nullopt in the degenerate case, or if an end
/// lies behind camera a.
std::optional<TriangulatedLine> TriangulateLine(const LineView& a, const LineView& b,
                                                const LineTriangulationOptions& options);

/// With the direction known: the line of that direction that fits all planes best, and the parts of
/// it that the first view shows. nullopt if the planes leave its place open, or it lies behind.
std::optional<TriangulatedLine> TriangulateLineAlong(const Eigen::Vector3d& direction,
                                                     std::span<const LineView> views,
                                                     const LineTriangulationOptions& options);

/// Point of the line (through `point`, along unit `direction`) that is nearest to a ray: its
/// parameter along the direction; nullopt if ray and line are parallel.
std::optional<double> NearestOnLine(const Eigen::Vector3d& point, const Eigen::Vector3d& direction,
                                    const Eigen::Vector3d& center, const Eigen::Vector3d& ray);

}  // namespace vpslam
