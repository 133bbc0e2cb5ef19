#include "core/map/line_view.h"

#include <algorithm>
#include <utility>

namespace vpslam {
namespace {

/// Keeps what of the segment from a to b has f >= 0, where f is linear with fa at a and fb at b.
template <class Vector>
bool Clip(double fa, double fb, Vector* a, Vector* b) {
  if (fa < 0 && fb < 0) return false;
  if (fa < 0) *a = *a + (fa / (fa - fb)) * (*b - *a);
  if (fb < 0) *b = *b + (fb / (fb - fa)) * (*a - *b);
  return true;
}

}  // namespace

std::optional<ImageSegment> PredictSegment(const MapLine& line, const SE3& cam_from_world,
                                           const Camera& camera, const Camera::Bounds& bounds,
                                           double min_length_px) {
  Eigen::Vector3d start = cam_from_world * line.start, end = cam_from_world * line.end;
  // A line that comes towards the camera is cut where it is near, compared with its far end.
  const double near = 0.05 * std::max(start.z(), end.z());
  if (!(near > 0) || !Clip(start.z() - near, end.z() - near, &start, &end)) return std::nullopt;
  ImageSegment s{camera.Project(start), camera.Project(end)};
  const auto inside = [&](double sign, int axis, double limit) {
    return Clip(sign * (s.start_px[axis] - limit), sign * (s.end_px[axis] - limit), &s.start_px,
                &s.end_px);
  };
  if (!inside(1, 0, bounds.min_x) || !inside(-1, 0, bounds.max_x) || !inside(1, 1, bounds.min_y) ||
      !inside(-1, 1, bounds.max_y)) {
    return std::nullopt;
  }
  if (s.Length() < min_length_px) return std::nullopt;
  return s;
}

}  // namespace vpslam
