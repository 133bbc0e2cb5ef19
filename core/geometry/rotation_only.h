// The rotation that explains the matches of two views without any translation.
//
// Two views that a rotation explains carry no structure, however many matches they have; to know
// that first is cheap.
#pragma once

#include <random>
#include <span>

#include <Eigen/Geometry>

#include "core/geometry/ransac.h"
#include "core/geometry/triangulation.h"

namespace vpslam {

struct RotationEstimate {
  Eigen::Quaterniond second_from_first = Eigen::Quaterniond::Identity();
  /// Matches whose squared transfer error over variance is below 5.991 (95 % of true matches).
  int num_inliers = 0;
};

/// Two matches at a time in a RANSAC loop, then least squares over the inliers.
RotationEstimate EstimateRotation(std::span<const RayMatch> matches, const RansacOptions& options,
                                  std::mt19937_64& rng);

}  // namespace vpslam
