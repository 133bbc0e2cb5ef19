#include "core/geometry/motion_refinement.h"

#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Dense>

namespace vpslam {
namespace {

using Vector5d = Eigen::Matrix<double, 5, 1>;
using Matrix5d = Eigen::Matrix<double, 5, 5>;

/// Sum of truncated squared residuals, and its Gauss-Newton system by a perturbation of the
/// rotation (left, first three) and of t within `tangent` (last two).
double Linearise(std::span<const RayMatch> matches, const SE3& motion,
                 const Eigen::Matrix<double, 3, 2>& tangent, double max_chi2, Matrix5d* h,
                 Vector5d* g) {
  const Eigen::Matrix3d r = motion.RotationMatrix();
  const Eigen::Vector3d& t = motion.translation;
  double cost = 0;
  if (h) h->setZero(), g->setZero();
  for (const RayMatch& m : matches) {
    const Eigen::Vector3d x2 = m.second.homogeneous();
    const Eigen::Vector3d p = r * m.first.homogeneous();
    const Eigen::Vector3d line_2 = t.cross(p);
    const Eigen::Vector3d n = x2.cross(t);
    const Eigen::Vector2d line_1 = r.leftCols<2>().transpose() * n;
    const double error = x2.dot(line_2);
    const Eigen::Vector2d w1 = m.first_variance.cwiseProduct(line_1);
    const Eigen::Vector2d w2 = m.second_variance.cwiseProduct(line_2.head<2>());
    const double variance = w1.dot(line_1) + w2.dot(line_2.head<2>());
    const double chi2 = error * error / variance;
    if (!(chi2 < max_chi2)) {
      cost += max_chi2;
      continue;
    }
    cost += chi2;
    if (!h) continue;
    // Residual error / sqrt(variance); the variance depends on the motion, too. With t' = t + dt
    // and R' = Exp(w) R: d line_2 = t x (w x p) + dt x p and d (R line_1) = n x w + x2 x dt.
    const double inverse_sigma = 1 / std::sqrt(variance);
    const Eigen::Vector3d u1 = r.leftCols<2>() * w1;  // R (w1, 0)
    const Eigen::Vector3d u2(w2.x(), w2.y(), 0);
    const Eigen::Vector3d error_by_w = p.cross(n);
    const Eigen::Vector3d error_by_t = p.cross(x2);
    const Eigen::Vector3d half_variance_by_w = u1.cross(n) + p.cross(u2.cross(t));
    const Eigen::Vector3d half_variance_by_t = u1.cross(x2) + p.cross(u2);
    const double ratio = error / variance;
    Vector5d j;
    j.head<3>() = inverse_sigma * (error_by_w - ratio * half_variance_by_w);
    j.tail<2>() = inverse_sigma * tangent.transpose() * (error_by_t - ratio * half_variance_by_t);
    h->selfadjointView<Eigen::Lower>().rankUpdate(j);
    *g += error * inverse_sigma * j;
  }
  return cost;
}

/// Two unit vectors orthogonal to t and to each other.
Eigen::Matrix<double, 3, 2> TangentBasis(const Eigen::Vector3d& t) {
  Eigen::Matrix<double, 3, 2> basis;
  basis.col(0) = t.unitOrthogonal();
  basis.col(1) = t.cross(basis.col(0));
  return basis;
}

}  // namespace

MotionRefinement RefineMotion(std::span<const RayMatch> matches,
                              const MotionRefinementOptions& options, SE3* second_from_first) {
  SE3& motion = *second_from_first;
  motion.translation.normalize();
  Matrix5d h;
  Vector5d g;
  Eigen::Matrix<double, 3, 2> tangent = TangentBasis(motion.translation);
  MotionRefinement result;
  result.cost = Linearise(matches, motion, tangent, options.max_chi2, &h, &g);
  double damping = 1e-4;
  for (int i = 0; i < options.max_iterations; ++i) {
    Matrix5d damped = h;
    damped.diagonal() *= 1 + damping;
    const Vector5d step = damped.selfadjointView<Eigen::Lower>().ldlt().solve(-g);
    if (!step.allFinite()) break;
    const SE3 moved(ExpSo3(step.head<3>()) * motion.rotation,
                    (motion.translation + tangent * step.tail<2>()).normalized());
    const double cost = Linearise(matches, moved, tangent, options.max_chi2, nullptr, nullptr);
    if (cost < result.cost) {
      const bool converged = result.cost - cost < 1e-6 * result.cost;
      motion = moved;
      tangent = TangentBasis(motion.translation);
      result.cost = Linearise(matches, motion, tangent, options.max_chi2, &h, &g);
      damping *= 0.1;
      if (converged) break;
    } else {
      damping *= 10;
      if (damping > 1e4) break;
    }
  }
  const Matrix5d full = h.selfadjointView<Eigen::Lower>();
  const Matrix5d covariance = full.inverse();
  const double trace = covariance(3, 3) + covariance(4, 4);
  const double determinant =
      covariance(3, 3) * covariance(4, 4) - covariance(3, 4) * covariance(4, 3);
  const double largest = 0.5 * trace + std::sqrt(std::max(0.0, 0.25 * trace * trace - determinant));
  result.direction_sigma_rad =
      largest >= 0 ? std::sqrt(largest) : std::numeric_limits<double>::infinity();
  return result;
}

MotionRefinement RefineMotionFromAfar(std::span<const RayMatch> matches, int max_iterations,
                                      SE3* second_from_first) {
  MotionRefinementOptions options;
  options.max_iterations = max_iterations;
  MotionRefinementOptions wide = options;
  wide.max_chi2 = 3 * options.max_chi2;
  RefineMotion(matches, wide, second_from_first);
  return RefineMotion(matches, options, second_from_first);
}

}  // namespace vpslam
