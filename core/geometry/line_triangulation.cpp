#include "core/geometry/line_triangulation.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "core/geometry/sphere.h"

namespace vpslam {

std::optional<TriangulatedLine> TriangulateLine(const LineView& a, const LineView& b,
                                                const LineTriangulationOptions& options) {
  const Eigen::Vector3d normal = b.Normal();
  const double height = normal.dot(b.center - a.center);
  const double min_sine = std::sin(options.min_ray_plane_angle_rad);
  TriangulatedLine line;
  for (const bool is_start : {true, false}) {
    const Eigen::Vector3d& ray = is_start ? a.start_ray : a.end_ray;
    const double sine = normal.dot(ray);
    if (!(std::abs(sine) >= min_sine)) return std::nullopt;
    const double range = height / sine;
    if (!(range > 0)) return std::nullopt;
    (is_start ? line.start : line.end) = a.center + range * ray;
  }
  return line;
}

std::optional<TriangulatedLine> TriangulateLineAlong(const Eigen::Vector3d& direction,
                                                     std::span<const LineView> views,
                                                     const LineTriangulationOptions& options) {
  if (views.size() < 2) return std::nullopt;
  // In the plane across the direction every view is a camera with one ray: n . (x - c) = 0.
  const Eigen::Matrix<double, 3, 2> across = TangentBasis(direction);
  const Eigen::Vector3d& origin = views.front().center;
  Eigen::Matrix2d h = Eigen::Matrix2d::Zero();
  Eigen::Vector2d g = Eigen::Vector2d::Zero();
  for (const LineView& view : views) {
    const Eigen::Vector2d n = (across.transpose() * view.Normal()).normalized();
    if (!n.allFinite()) return std::nullopt;
    h += n * n.transpose();
    g += n * n.dot(across.transpose() * (view.center - origin));
  }
  // The smaller eigenvalue is about half the squared angle between two rays.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(h, Eigen::EigenvaluesOnly);
  const double angle = options.min_ray_plane_angle_rad;
  if (!(eigen.eigenvalues()[0] >= 0.5 * angle * angle)) return std::nullopt;
  const Eigen::Vector3d point = origin + across * h.ldlt().solve(g);
  TriangulatedLine line;
  for (const bool is_start : {true, false}) {
    const Eigen::Vector3d& ray = is_start ? views.front().start_ray : views.front().end_ray;
    const auto s = NearestOnLine(point, direction, origin, ray);
    if (!s) return std::nullopt;
    const Eigen::Vector3d x = point + *s * direction;
    if (!(ray.dot(x - origin) > 0)) return std::nullopt;
    (is_start ? line.start : line.end) = x;
  }
  return line;
}

std::optional<double> NearestOnLine(const Eigen::Vector3d& point, const Eigen::Vector3d& direction,
                                    const Eigen::Vector3d& center, const Eigen::Vector3d& ray) {
  const double cosine = direction.dot(ray);
  const double sine2 = 1 - cosine * cosine;
  if (!(sine2 > 1e-6)) return std::nullopt;
  const Eigen::Vector3d to_point = point - center;
  return (cosine * ray.dot(to_point) - direction.dot(to_point)) / sine2;
}

}  // namespace vpslam
