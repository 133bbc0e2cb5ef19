// The pose of one frame from points whose positions are known: robust Gauss-Newton on SE(3).
//
// Four rounds of up to ten iterations, as is usual since [Mur15] sec. V: in each, measurements that
// fail the chi-square gate are left out; after each, all are judged again. The last two rounds have
// no robust loss, since by then outliers are gone.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/camera.h"
#include "core/geometry/se3.h"

namespace vpslam {

struct PointMeasurement {
  Eigen::Vector3d point_in_world;
  Eigen::Vector2d px;
  double inv_sigma2 = 1;  ///< 1 / px^2, by octave
};

struct PoseOptimizerOptions {
  int rounds = 4;
  int iterations_per_round = 10;

  template <class V>
  void Visit(V& v) {
    v("rounds", rounds);
    v("iterations_per_round", iterations_per_round);
  }
};

struct PoseEstimate {
  SE3 cam_from_world;
  Matrix6d covariance = Matrix6d::Zero();  ///< of the left perturbation, for the stated sigmas
  std::vector<uint8_t> inliers;            ///< per measurement
  int num_inliers = 0;
};

/// With fewer than three measurements the initial pose comes back, and no inlier.
PoseEstimate OptimizePose(const Camera& camera, std::span<const PointMeasurement> points,
                          const SE3& initial_cam_from_world, const PoseOptimizerOptions& options);

}  // namespace vpslam
