// The essential matrix E = [t]_x R of two calibrated views: x_second^T E x_first = 0.
//
// Estimated from five matches at a time ([Nis04] "An efficient solution to the five-point relative
// pose problem"), in a RANSAC loop with local optimisation of each new best ([Chu03] "Locally
// optimized RANSAC"). Unlike eight points and a projection to the essential manifold, five
// calibrated points have no degenerate plane.
#pragma once

#include <array>
#include <random>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/ransac.h"
#include "core/geometry/se3.h"
#include "core/geometry/triangulation.h"

namespace vpslam {

/// All essential matrices (up to 10, of norm sqrt(2), with either sign) that fit five pairs of
/// normalised coordinates. Empty if the pairs are degenerate.
std::vector<Eigen::Matrix3d> SolveFivePoint(const std::array<Eigen::Vector2d, 5>& first,
                                            const std::array<Eigen::Vector2d, 5>& second);

Eigen::Matrix3d EssentialFromMotion(const SE3& second_from_first);

/// The four second_from_first with |t| = 1 that give E up to its sign and scale ([HZ04] sec. 9.6).
std::array<SE3, 4> DecomposeEssential(const Eigen::Matrix3d& essential);

/// Squared error of the epipolar constraint over its variance to first order (Sampson's distance):
/// chi-square with one degree of freedom for a true match.
double SampsonChi2(const Eigen::Matrix3d& essential, const RayMatch& match);

/// [Mur15] eq. 2 with both directions expressed by Sampson's distance: an inlier (chi2 < 3.841)
/// scores 2 (5.991 - chi2), so that it is comparable with a homography's score. Gives up, and
/// returns 0, once `to_beat` is out of reach.
double EssentialScore(const Eigen::Matrix3d& essential, std::span<const RayMatch> matches,
                      double to_beat = 0);

struct EssentialEstimate {
  SE3 motion;  ///< one of the four decompositions, |t| = 1
  double score = 0;
  int iterations = 0;
};

/// Score 0 if there are fewer than five matches or no sample gave anything.
EssentialEstimate EstimateEssential(std::span<const RayMatch> matches, const RansacOptions& options,
                                    std::mt19937_64& rng);

}  // namespace vpslam
