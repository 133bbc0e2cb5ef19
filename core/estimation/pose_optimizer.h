// The pose of one frame from points and lines whose positions are known, and from a measured
// rotation: robust Gauss-Newton on SE(3) (paper sec. III-C, first estimate).
//
// Four rounds of up to ten iterations, as is usual since [Mur15] sec. V: in each, measurements that
// fail the chi-square gate are left out; after each, all are judged again. The last two rounds have
// no robust loss, since by then outliers are gone. A measured rotation is never left out, and its
// loss is robust to the end: it pulls at a pose that drifts away from it with the same force.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/geometry/camera.h"
#include "core/geometry/se3.h"

namespace vpslam {

struct PointMeasurement {
  Eigen::Vector3d point_in_world;
  Eigen::Vector2d px;
  /// Symmetric, 1 / px: times a residual in px it gives sigmas.
  Eigen::Matrix2d sqrt_information = Eigen::Matrix2d::Identity();
};

/// A segment that shows a line through `start_in_world` and `end_in_world`; its own ends are
/// anywhere on the line.
struct LineMeasurement {
  Eigen::Vector3d start_in_world, end_in_world;
  Eigen::Vector2d start_px, end_px;
  double inv_sigma2 = 1;  ///< 1 / px^2, of either end point across the line
};

/// A rotation that does not come from points and lines.
struct RotationMeasurement {
  Eigen::Quaterniond cam_from_world;
  Eigen::Matrix3d information;  ///< 1 / rad^2, of the left perturbation
};

struct PoseMeasurements {
  std::vector<PointMeasurement> points;
  std::vector<LineMeasurement> lines;
  std::optional<RotationMeasurement> rotation;
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
  std::vector<uint8_t> inliers;            ///< per point
  std::vector<uint8_t> line_inliers;       ///< per line
  int num_inliers = 0;                     ///< points
  int num_line_inliers = 0;
};

/// With fewer than three points and lines the initial pose comes back, and no inlier.
PoseEstimate OptimizePose(const Camera& camera, const PoseMeasurements& measurements,
                          const SE3& initial_cam_from_world, const PoseOptimizerOptions& options);

}  // namespace vpslam
