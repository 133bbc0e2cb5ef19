#include "backend/line_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "backend/central_descriptor.h"
#include "core/estimation/line_residual.h"
#include "core/estimation/point_residual.h"
#include "core/geometry/chi_square.h"

namespace vpslam {
namespace {

// A vanishing point farther than that from an axis is a direction of its own.
constexpr double kMaxAxisAngle_rad = 4 * std::numbers::pi / 180;

}  // namespace

LineView ViewSegment(const LineSegment& segment, const SE3& cam_from_world, const Camera& camera) {
  const Eigen::Quaterniond world_from_cam = cam_from_world.rotation.conjugate();
  const auto ray = [&](const Eigen::Vector2f& px) {
    return (world_from_cam * camera.Unproject(px.cast<double>())).normalized();
  };
  return {cam_from_world.Center(), ray(segment.start_px), ray(segment.end_px)};
}

int AxisOf(const LineSegment& segment, const LineSet& lines, const Keyframe& keyframe,
           const Map& map) {
  const ManhattanAxes* axes = map.Find(keyframe.manhattan);
  if (!axes || segment.label < 0) return -1;
  const Eigen::Vector3d direction =
      (keyframe.cam_from_world.rotation * axes->world_from_manhattan).conjugate() *
      lines.vanishing_points[static_cast<size_t>(segment.label)].direction_in_cam;
  Eigen::Index axis = 0;
  return direction.cwiseAbs().maxCoeff(&axis) > std::cos(kMaxAxisAngle_rad) ? static_cast<int>(axis)
                                                                            : -1;
}

Eigen::Vector3d AxisDirection(int axis, ManhattanId manhattan, const Map& map) {
  return map.Find(manhattan)->world_from_manhattan * Eigen::Vector3d(Eigen::Vector3d::Unit(axis));
}

void UpdateEnds(LineId id, const Camera& camera, OwnedMap* map) {
  const MapLine* line = map->Find(id);
  if (!line || line->observations.empty()) return;
  const Eigen::Vector3d direction = line->Direction();
  std::vector<double> from, to;
  for (const Observation& o : line->observations) {
    const Keyframe& keyframe = *map->Find(o.keyframe);
    const LineView view =
        ViewSegment(keyframe.seen->segments()[o.feature], keyframe.cam_from_world, camera);
    const auto a = NearestOnLine(line->start, direction, view.center, view.start_ray);
    const auto b = NearestOnLine(line->start, direction, view.center, view.end_ray);
    if (!a || !b) continue;
    from.push_back(std::min(*a, *b));
    to.push_back(std::max(*a, *b));
  }
  if (from.empty()) return;
  // Of many views, the quarter that shows most: not the one that two edges were joined in.
  const size_t at = from.size() / 4;
  std::nth_element(from.begin(), from.begin() + static_cast<std::ptrdiff_t>(at), from.end());
  std::nth_element(to.begin(), to.begin() + static_cast<std::ptrdiff_t>(at), to.end(),
                   std::greater<>());
  if (!(to[at] > from[at])) return;
  const Eigen::Vector3d start = line->start;
  map->SetEnds(id, start + from[at] * direction, start + to[at] * direction);
}

void UpdateDescriptor(LineId id, OwnedMap* map) {
  const MapLine* line = map->Find(id);
  if (!line || line->observations.empty()) return;
  map->SetDescriptor(id, CentralDescriptor(line->observations, [&](const Observation& o) {
                       return map->Find(o.keyframe)->seen->segments()[o.feature].descriptor;
                     }));
}

bool Fits(const MapLine& line, const SE3& cam_from_world, const LineSegment& segment,
          const Camera& camera) {
  const Eigen::Vector3d start = cam_from_world * line.start, end = cam_from_world * line.end;
  if (start.z() < kMinDepth && end.z() < kMinDepth) return false;
  const double sigma_px = LineSigma_px(segment.sigma_px);
  return EvaluateLineResidual(camera, start.cross(end), segment.start_px.cast<double>(),
                              segment.end_px.cast<double>(), false)
             .value.squaredNorm() <= kChi2Dof2 * sigma_px * sigma_px;
}

bool IsTooNear(const MapLine& line, const SE3& cam_from_world, double min_depth) {
  return line.axis < 0 &&
         std::max((cam_from_world * line.start).z(), (cam_from_world * line.end).z()) < min_depth;
}

}  // namespace vpslam
