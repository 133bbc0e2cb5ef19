// Refines the motion between two views by the epipolar error alone, without points.
#pragma once

#include <span>

#include <Eigen/Core>

#include "core/geometry/chi_square.h"
#include "core/geometry/se3.h"
#include "core/geometry/triangulation.h"

namespace vpslam {

struct MotionRefinementOptions {
  int max_iterations = 15;
  /// Matches with a greater squared Sampson error over variance do not take part.
  double max_chi2 = kChi2Dof1;
};

struct MotionRefinement {
  /// Sum of min(chi2, max_chi2) over all matches.
  double cost = 0;
  /// Largest standard deviation of the translation's direction, to first order; the cost's Hessian
  /// being taken at full confidence in the given variances. Infinity if it is undetermined.
  double direction_sigma_rad = 0;
};

/// Minimises the sum of truncated squared Sampson distances over the rotation and the direction of
/// the translation: 5 degrees of freedom, Levenberg-Marquardt. That is the reprojection error
/// minimised over motion and points, to first order in the error of an observation ([HZ04] sec.
/// 11.4.3), without the points as unknowns. Leaves |t| = 1.
MotionRefinement RefineMotion(std::span<const RayMatch> matches,
                              const MotionRefinementOptions& options, SE3* second_from_first);

/// The same from a rough start: first with three times the max_chi2, so that the minimum next to a
/// start which excludes many true matches does not catch it. Up to max_iterations for each.
MotionRefinement RefineMotionFromAfar(std::span<const RayMatch> matches, int max_iterations,
                                      SE3* second_from_first);

}  // namespace vpslam
