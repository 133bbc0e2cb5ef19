// The translation of a frame whose rotation is known, from points, by a linear system (paper sec.
// III-C, eq. 11 and 12).
//
// With X' = R X, and x = (u - cx) / fx, y = (v - cy) / fy, a point gives the rows
//   A = [-1 0 x; 0 -1 y],  b = [X'_1 - X'_3 x; X'_2 - X'_3 y],  A t = b
// whose error is the reprojection error times the depth. Dividing by the depth makes it the
// reprojection error itself, so that far points do not decide.
#pragma once

#include <optional>
#include <random>
#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/estimation/pose_optimizer.h"
#include "core/geometry/camera.h"

namespace vpslam {

enum class TranslationWeights {
  kNone,          ///< eq. 12 as it is
  kInverseDepth,  ///< rows by 1 / (depth sigma)
};

/// RANSAC over two points at a time, whose inliers pass the chi-square gate, then least squares
/// over all inliers, A^T A t = A^T b (the paper omits A^T on the right); twice with kInverseDepth,
/// for depths depend on t. nullopt for fewer than `min_inliers`, or where all lie about one ray.
std::optional<Eigen::Vector3d> EstimateTranslation(const Camera& camera,
                                                   std::span<const PointMeasurement> points,
                                                   const Eigen::Quaterniond& cam_from_world,
                                                   TranslationWeights weights, int min_inliers,
                                                   std::mt19937_64& rng);

}  // namespace vpslam
