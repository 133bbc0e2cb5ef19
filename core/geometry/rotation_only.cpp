#include "core/geometry/rotation_only.h"

#include <Eigen/SVD>

#include "core/geometry/chi_square.h"
#include "core/geometry/homography.h"
#include "core/geometry/random_sample.h"

namespace vpslam {
namespace {

/// Orthonormal frame along a, with b in the plane of its first two columns.
Eigen::Matrix3d Triad(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  Eigen::Matrix3d frame;
  frame.col(0) = a.homogeneous().normalized();
  frame.col(2) = a.homogeneous().cross(b.homogeneous()).normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

int CountInliers(const Eigen::Matrix3d& rotation, std::span<const RayMatch> matches) {
  int inliers = 0;
  for (const RayMatch& match : matches) inliers += TransferChi2(rotation, match) < kChi2Dof2;
  return inliers;
}

}  // namespace

RotationEstimate EstimateRotation(std::span<const RayMatch> matches, const RansacOptions& options,
                                  std::mt19937_64& rng) {
  RotationEstimate best;
  const int n = static_cast<int>(matches.size());
  if (n < 2) return best;
  Eigen::Matrix3d best_rotation = Eigen::Matrix3d::Identity();
  best.num_inliers = CountInliers(best_rotation, matches);
  int required = options.max_iterations;
  for (int iteration = 0; iteration < required; ++iteration) {
    const std::array<int, 2> sample = RandomSample<2>(n, rng);
    const RayMatch &a = matches[sample[0]], &b = matches[sample[1]];
    Eigen::Matrix3d rotation = Triad(a.second, b.second) * Triad(a.first, b.first).transpose();
    if (!rotation.allFinite()) continue;
    int inliers = CountInliers(rotation, matches);
    if (inliers < 0.7 * best.num_inliers || inliers < 2) continue;
    // Least squares over the inliers, as long as that helps: [Ume91] with unit vectors.
    for (int round = 0; round < 3; ++round) {
      Eigen::Matrix3d correlation = Eigen::Matrix3d::Zero();
      for (const RayMatch& m : matches) {
        if (!(TransferChi2(rotation, m) < kChi2Dof2)) continue;
        const double weight = 1 / (m.first_variance.sum() + m.second_variance.sum());
        const Eigen::Vector3d x1 = m.first.homogeneous(), x2 = m.second.homogeneous();
        correlation += weight * x2.normalized() * x1.normalized().transpose();
      }
      const Eigen::JacobiSVD<Eigen::Matrix3d> svd(correlation,
                                                  Eigen::ComputeFullU | Eigen::ComputeFullV);
      Eigen::Matrix3d u = svd.matrixU();
      if (u.determinant() * svd.matrixV().determinant() < 0) u.col(2) = -u.col(2);
      const Eigen::Matrix3d fitted = u * svd.matrixV().transpose();
      const int fitted_inliers = CountInliers(fitted, matches);
      if (fitted_inliers <= inliers) break;
      rotation = fitted;
      inliers = fitted_inliers;
    }
    if (inliers <= best.num_inliers) continue;
    best.num_inliers = inliers;
    best_rotation = rotation;
    required = RequiredIterations(options, static_cast<double>(inliers) / n, 2);
  }
  best.second_from_first = Eigen::Quaterniond(best_rotation).normalized();
  return best;
}

}  // namespace vpslam
