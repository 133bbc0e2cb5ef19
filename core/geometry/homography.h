// The homography between two views of a plane, or of anything under pure rotation:
// x_second ~ H x_first in normalised coordinates.
#pragma once

#include <array>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/ransac.h"
#include "core/geometry/se3.h"
#include "core/geometry/triangulation.h"

namespace vpslam {

/// The homography through four pairs of normalised coordinates; nullopt if three points are nearly
/// on a line, or seen from different sides (which no plane in front of both cameras does).
std::optional<Eigen::Matrix3d> SolveFourPoint(const std::array<Eigen::Vector2d, 4>& first,
                                              const std::array<Eigen::Vector2d, 4>& second);

/// [Mur15] eq. 2: the sum over both directions of 5.991 - chi2 where that is positive, chi2 being
/// the squared transfer error over the sum of both variances. Gives up, and returns 0, once
/// `to_beat` is out of reach.
double HomographyScore(const Eigen::Matrix3d& homography, std::span<const RayMatch> matches,
                       double to_beat = 0);

/// Squared transfer error to the second image over the sum of both variances (exact where H does
/// not scale): chi-square with two degrees of freedom for a true match.
double TransferChi2(const Eigen::Matrix3d& homography, const RayMatch& match);

/// Minimises the sum of squared transfer errors, truncated at max_chi2, over the 8 degrees of
/// freedom.
void RefineHomography(std::span<const RayMatch> matches, int max_iterations, double max_chi2,
                      Eigen::Matrix3d* homography);

struct HomographyEstimate {
  Eigen::Matrix3d homography = Eigen::Matrix3d::Identity();
  double score = 0;
  int iterations = 0;
};

/// Four points at a time in a RANSAC loop with local optimisation; score 0 if there are fewer than
/// four matches or no sample gave anything.
HomographyEstimate EstimateHomography(std::span<const RayMatch> matches,
                                      const RansacOptions& options, std::mt19937_64& rng);

/// The motions H = s (R + t n^T) can come from, at most four, with |t| = 1; n is the plane's normal
/// in the first camera up to its length ([Ma04] "An Invitation to 3-D Vision" sec. 5.3.3; after
/// Faugeras and Lustman). Which side the points are on has to be tested. Empty if H is a rotation
/// to within `min_translation`, the length of t over the distance of the plane.
std::vector<SE3> DecomposeHomography(const Eigen::Matrix3d& homography,
                                     double min_translation = 1e-4);

}  // namespace vpslam
