// Segments of a made-up Manhattan world, with exact truth; noise and outliers are added separately.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/geometry/camera.h"
#include "core/geometry/so3.h"
#include "vpdetector/edge_fit.h"

namespace vpslam {

inline Camera SceneCamera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 520;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

struct VpSceneOptions {
  Eigen::Quaterniond cam_from_manhattan = Eigen::Quaterniond::Identity();
  /// Segments along each axis, and along no axis at all.
  int axis_lines[3] = {20, 20, 20};
  int outliers = 0;
  double min_length_px = 40, max_length_px = 150;
  double sigma_px = 0.3;         ///< noise of end points across the segment
  double world_sigma_deg = 0.0;  ///< noise of the direction in the world
  uint64_t seed = 1;
};

struct VpScene {
  Camera camera;
  std::vector<EdgeSegment> segments;
  std::vector<int32_t> truth_labels;
};

inline VpScene MakeVpScene(const VpSceneOptions& options) {
  VpScene scene{SceneCamera(), {}, {}};
  std::mt19937_64 rng(options.seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> normal(0, 1);
  const auto add = [&](const Eigen::Vector2d& middle, const Eigen::Vector2d& way, double length,
                       int label) {
    const Eigen::Vector2d across(-way.y(), way.x());
    EdgeSegment s;
    s.start_px = middle - 0.5 * length * way + options.sigma_px * normal(rng) * across;
    s.end_px = middle + 0.5 * length * way + options.sigma_px * normal(rng) * across;
    s.sigma_px = std::max(0.05, options.sigma_px);
    scene.segments.push_back(s);
    scene.truth_labels.push_back(label);
  };
  const auto random_middle = [&] {
    return Eigen::Vector2d(scene.camera.width * unit(rng), scene.camera.height * unit(rng));
  };
  const auto random_length = [&] {
    return options.min_length_px + (options.max_length_px - options.min_length_px) * unit(rng);
  };
  const Eigen::Matrix3d r = options.cam_from_manhattan.toRotationMatrix();
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < options.axis_lines[axis];) {
      const Eigen::Vector3d tilt = options.world_sigma_deg * std::numbers::pi / 180.0 *
                                   Eigen::Vector3d(normal(rng), normal(rng), normal(rng));
      const Eigen::Vector3d d = ExpSo3(tilt) * r.col(axis);
      const Eigen::Vector2d middle = random_middle();
      // The image of the axis through the middle's ray points to its vanishing point.
      const Eigen::Vector3d ray = scene.camera.Unproject(middle);
      const Eigen::Vector2d way = d.head<2>() - d.z() * ray.head<2>();
      if (way.norm() < 0.2) continue;  // seen end on
      add(middle, way.normalized(), random_length(), axis);
      ++i;
    }
  }
  for (int i = 0; i < options.outliers; ++i) {
    const double angle = std::numbers::pi * unit(rng);
    add(random_middle(), {std::cos(angle), std::sin(angle)}, random_length(), -1);
  }
  return scene;
}

/// Uniform over all rotations.
inline Eigen::Quaterniond RandomRotation(std::mt19937_64& rng) {
  std::normal_distribution<double> normal(0, 1);
  return Eigen::Quaterniond(normal(rng), normal(rng), normal(rng), normal(rng)).normalized();
}

/// The left perturbation that takes the estimate to the truth, of all 24 that name the same axes
/// the smallest.
inline Eigen::Vector3d RotationErrorVector(const Eigen::Matrix3d& estimate,
                                           const Eigen::Matrix3d& truth) {
  const Eigen::Matrix3d p = truth.transpose() * estimate;
  Eigen::Matrix3d permutation = Eigen::Matrix3d::Zero();
  for (int column = 0; column < 3; ++column) {
    Eigen::Index row = 0;
    p.col(column).cwiseAbs().maxCoeff(&row);
    permutation(row, column) = p(row, column) > 0 ? 1 : -1;
  }
  return LogSo3(Eigen::Quaterniond(Eigen::Matrix3d(truth * permutation * estimate.transpose())));
}

inline double RotationErrorSceneDeg(const Eigen::Matrix3d& estimate,
                                    const Eigen::Quaterniond& truth) {
  return RotationErrorVector(estimate, truth.toRotationMatrix()).norm() * 180 / std::numbers::pi;
}

}  // namespace vpslam
