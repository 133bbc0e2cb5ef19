// Where and how large a map point should appear in a view, and whether it should at all.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "core/estimation/point_residual.h"
#include "core/features/scale_levels.h"
#include "core/geometry/camera.h"
#include "core/geometry/se3.h"
#include "core/map/map.h"

namespace vpslam {

struct PredictedView {
  Eigen::Vector2d px;
  int octave = 0;
  double depth = 0;        ///< map units
  double view_cosine = 0;  ///< between the viewing ray and the point's mean viewing direction
};

/// Limits within which a descriptor taken elsewhere is still recognised.
struct VisibilityOptions {
  double min_view_cosine = 0.5;  ///< 60 degrees from the mean viewing direction
  double distance_slack = 1.2;   ///< beyond the distances that the pyramid covers
};

/// nullopt if the point lies behind the camera or outside `bounds`, or is seen too obliquely, from
/// too near or from too far.
inline std::optional<PredictedView> PredictView(const MapPoint& point, const SE3& cam_from_world,
                                                const Eigen::Vector3d& camera_center,
                                                const Camera& camera, const Camera::Bounds& bounds,
                                                const ScalePyramid& scales,
                                                const VisibilityOptions& options = {}) {
  const Eigen::Vector3d x = cam_from_world * point.position;
  if (x.z() < kMinDepth) return std::nullopt;
  PredictedView view;
  view.px = camera.Project(x);
  if (!bounds.Contains(view.px)) return std::nullopt;
  const Eigen::Vector3d ray = camera_center - point.position;
  const double distance = ray.norm();
  if (distance > point.max_distance * options.distance_slack ||
      distance * options.distance_slack < scales.MinDistance(point.max_distance)) {
    return std::nullopt;
  }
  view.view_cosine = ray.dot(point.normal) / distance;
  if (view.view_cosine < options.min_view_cosine) return std::nullopt;
  view.octave = scales.PredictOctave(distance, point.max_distance);
  view.depth = x.z();
  return view;
}

}  // namespace vpslam
