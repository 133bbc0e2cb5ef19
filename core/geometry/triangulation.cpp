#include "core/geometry/triangulation.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Dense>

namespace vpslam {
namespace {

/// Below this angle two rays are parallel to the accuracy of any image.
constexpr double kMinParallax_rad = 1e-5;

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

RayMatch MakeRayMatch(const Camera& camera, const Eigen::Vector2d& first_px,
                      const Eigen::Vector2d& second_px, double first_sigma_px,
                      double second_sigma_px) {
  const Eigen::Array2d focal_px(camera.fx, camera.fy);
  RayMatch match;
  match.first = camera.Unproject(first_px).head<2>();
  match.second = camera.Unproject(second_px).head<2>();
  match.first_variance = (first_sigma_px / focal_px).square();
  match.second_variance = (second_sigma_px / focal_px).square();
  return match;
}

std::optional<Eigen::Vector3d> TriangulateTwoView(const SE3& second_from_first,
                                                  const RayMatch& match, double* parallax_rad) {
  const Eigen::Matrix3d rotation = second_from_first.RotationMatrix();
  const Eigen::Vector3d& t = second_from_first.translation;
  const Eigen::Vector3d measured_1 = match.first.homogeneous();
  const Eigen::Vector3d measured_2 = match.second.homogeneous();
  Eigen::Vector3d x1 = measured_1, x2 = measured_2;
  for (int i = 0; i < 2; ++i) {
    // Constraint linearised at (x1, x2), and evaluated at the measurement.
    const Eigen::Vector3d line_2 = t.cross(rotation * x1);
    const Eigen::Vector3d line_1 = rotation.transpose() * x2.cross(t);
    const double error = x2.dot(line_2) + line_1.dot(measured_1 - x1) + line_2.dot(measured_2 - x2);
    const Eigen::Vector2d step_1 = match.first_variance.cwiseProduct(line_1.head<2>());
    const Eigen::Vector2d step_2 = match.second_variance.cwiseProduct(line_2.head<2>());
    const double variance = step_1.dot(line_1.head<2>()) + step_2.dot(line_2.head<2>());
    if (!(variance > 0)) return std::nullopt;
    x1.head<2>() = match.first - error / variance * step_1;
    x2.head<2>() = match.second - error / variance * step_2;
  }
  // depth_1 R x1 + t = depth_2 x2
  const Eigen::Vector3d p = rotation * x1;
  const Eigen::Vector3d normal = x2.cross(p);
  const double n2 = normal.squaredNorm();
  if (!(n2 > kMinParallax_rad * kMinParallax_rad * x2.squaredNorm() * p.squaredNorm())) {
    return std::nullopt;
  }
  const double depth_1 = -normal.dot(x2.cross(t)) / n2;
  const double depth_2 = -normal.dot(p.cross(t)) / n2;
  if (!(depth_1 > 0 && depth_2 > 0)) return std::nullopt;
  if (parallax_rad) *parallax_rad = AngleBetween(x2, p);
  return Eigen::Vector3d(depth_1 * x1);
}

std::optional<Eigen::Vector3d> TriangulateLinear(std::span<const RayObservation> observations) {
  if (observations.size() < 2) return std::nullopt;
  // Normal matrix of the homogeneous system; 4 x 4 whatever the number of views.
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  // Solved around the first camera, in units of the largest baseline: poses far from the origin of
  // the world would cost digits.
  const Eigen::Vector3d origin = observations.front().cam_from_world.Center();
  double scale = 0;
  for (const RayObservation& o : observations) {
    scale = std::max(scale, (o.cam_from_world.Center() - origin).norm());
  }
  if (!(scale > 0) || !std::isfinite(scale)) return std::nullopt;
  for (const RayObservation& o : observations) {
    if (!o.position.allFinite() || !(o.sigma > 0)) return std::nullopt;
    Eigen::Matrix<double, 3, 4> p;
    p.leftCols<3>() = o.cam_from_world.RotationMatrix();
    p.col(3) = (o.cam_from_world * origin) / scale;
    const double norm = o.position.homogeneous().norm();
    for (int k = 0; k < 2; ++k) {
      const Eigen::RowVector4d row = (o.position[k] * p.row(2) - p.row(k)) / (norm * o.sigma);
      normal += row.transpose() * row;
    }
  }
  if (!normal.allFinite()) return std::nullopt;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(normal);
  if (!(eigen.eigenvalues()[1] > 1e-12 * eigen.eigenvalues()[3])) return std::nullopt;
  const Eigen::Vector4d x = eigen.eigenvectors().col(0);
  if (std::abs(x[3]) < 1e-9) return std::nullopt;
  return Eigen::Vector3d(origin + scale * x.head<3>() / x[3]);
}

std::optional<std::string> TriangulationOptions::Validate() const {
  if (!(min_parallax_rad >= 0)) return "min_parallax_rad must not be negative";
  if (max_iterations < 0) return "max_iterations must not be negative";
  return std::nullopt;
}

std::optional<Eigen::Vector3d> Triangulate(std::span<const RayObservation> observations,
                                           const TriangulationOptions& options) {
  const std::optional<Eigen::Vector3d> linear = TriangulateLinear(observations);
  if (!linear) return std::nullopt;
  Eigen::Vector3d point = *linear;
  const auto cost_at = [&](const Eigen::Vector3d& x) {
    double cost = 0;
    for (const RayObservation& o : observations) cost += ReprojectionChi2(o, x);
    return cost;
  };
  double cost = cost_at(point);
  if (!std::isfinite(cost)) return std::nullopt;  // behind a camera
  double damping = 0;
  for (int i = 0; i < options.max_iterations; ++i) {
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (const RayObservation& o : observations) {
      const Eigen::Matrix3d rotation = o.cam_from_world.RotationMatrix();
      const Eigen::Vector3d x = o.cam_from_world * point;
      const double inverse_z = 1 / x.z();
      const Eigen::Vector2d projected = x.head<2>() * inverse_z;
      Eigen::Matrix<double, 2, 3> j = rotation.topRows<2>() - projected * rotation.row(2);
      j *= inverse_z / o.sigma;
      h += j.transpose() * j;
      g += j.transpose() * ((projected - o.position) / o.sigma);
    }
    h.diagonal() *= 1 + damping;
    const Eigen::Vector3d step = h.ldlt().solve(-g);
    if (!step.allFinite()) break;
    const double new_cost = cost_at(point + step);
    if (new_cost <= cost) {
      point += step;
      const bool converged = cost - new_cost <= 1e-10 * cost;
      cost = new_cost;
      damping *= 0.1;
      if (converged) break;
    } else {
      damping = std::max(1e-3, 10 * damping);
    }
  }
  double parallax_rad = 0;
  for (size_t a = 0; a < observations.size(); ++a) {
    const Eigen::Vector3d center = observations[a].cam_from_world.Center();
    for (size_t b = a + 1; b < observations.size(); ++b) {
      parallax_rad = std::max(parallax_rad,
                              Parallax_rad(point, center, observations[b].cam_from_world.Center()));
    }
  }
  if (!(parallax_rad >= options.min_parallax_rad)) return std::nullopt;
  return point;
}

double Parallax_rad(const Eigen::Vector3d& point, const Eigen::Vector3d& center_a,
                    const Eigen::Vector3d& center_b) {
  return AngleBetween(center_a - point, center_b - point);
}

double ReprojectionChi2(const RayObservation& observation, const Eigen::Vector3d& point_in_world) {
  const Eigen::Vector3d x = observation.cam_from_world * point_in_world;
  if (!(x.z() > 0)) return std::numeric_limits<double>::infinity();
  return (x.head<2>() / x.z() - observation.position).squaredNorm() /
         (observation.sigma * observation.sigma);
}

}  // namespace vpslam
