#include "core/estimation/absolute_rotation.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/SVD>

#include "core/geometry/so3.h"

namespace vpslam {
namespace {

double Cost(std::span<const DirectionPair> pairs, const Eigen::Quaterniond& rotation) {
  double cost = 0;
  for (const DirectionPair& pair : pairs) {
    const double angle =
        std::acos(std::min(1.0, std::abs(pair.in_cam.dot(rotation * pair.in_world))));
    cost += angle * angle;
  }
  return cost;
}

}  // namespace

std::optional<Eigen::Vector3d> DominantDirection(std::span<const Eigen::Vector3d> normals) {
  if (normals.size() < 2) return std::nullopt;
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();  // S S^T has the left singular vectors of S
  for (const Eigen::Vector3d& s : normals) scatter += s * s.transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(scatter, Eigen::ComputeFullU);
  constexpr double kParallel = 1e-6;
  if (!(svd.singularValues()[1] > kParallel * svd.singularValues()[0])) return std::nullopt;
  return svd.matrixU().col(2);
}

std::array<std::optional<Eigen::Vector3d>, 3> DominantDirections(const LineSet& lines,
                                                                 const Camera& camera,
                                                                 int min_lines) {
  std::array<std::optional<Eigen::Vector3d>, 3> directions;
  if (lines.manhattan == ManhattanState::kNone) return directions;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Eigen::Vector3d> normals;
    for (const LineSegment& line : lines.lines) {
      if (line.label != axis) continue;
      normals.push_back(camera.Unproject(line.start_px.cast<double>())
                            .cross(camera.Unproject(line.end_px.cast<double>()))
                            .normalized());
    }
    if (static_cast<int>(normals.size()) >= min_lines) {
      directions[axis] = DominantDirection(normals);
    }
  }
  return directions;
}

Eigen::Quaterniond OptimizeAbsoluteRotation(std::span<const DirectionPair> pairs,
                                            const Eigen::Quaterniond& cam_from_world) {
  constexpr int kMaxIterations = 20;
  constexpr double kMaxDamping = 1e6;
  Eigen::Quaterniond rotation = cam_from_world;
  double cost = Cost(pairs, rotation), damping = 1e-4;
  for (int i = 0; i < kMaxIterations && damping < kMaxDamping; ++i) {
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (const DirectionPair& pair : pairs) {
      const Eigen::Vector3d d = rotation * pair.in_world;
      const double sign = pair.in_cam.dot(d) < 0 ? -1 : 1;
      const double cosine = std::min(1.0, sign * pair.in_cam.dot(d));
      const double sine = std::sqrt(1 - cosine * cosine);
      if (sine < 1e-9) continue;  // the paper's Jacobian is 0 / 0 at the optimum
      // d angle / d w = -(delta . (w x d)) / sin: a row of norm 1 always.
      const Eigen::Vector3d j = -sign * d.cross(pair.in_cam) / sine;
      h += j * j.transpose();
      g += j * std::acos(cosine);
    }
    h.diagonal().array() += damping;
    const Eigen::Vector3d step = h.ldlt().solve(-g);
    const Eigen::Quaterniond candidate = (ExpSo3(step) * rotation).normalized();
    const double candidate_cost = Cost(pairs, candidate);
    if (candidate_cost < cost) {
      rotation = candidate;
      cost = candidate_cost;
      damping *= 0.1;
      if (step.norm() < 1e-9) break;
    } else {
      damping *= 10;
    }
  }
  return rotation;
}

}  // namespace vpslam
