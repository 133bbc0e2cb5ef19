#include "core/geometry/p3p.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Dense>

#include "core/geometry/polynomial.h"

namespace vpslam {
namespace {

/// Orthonormal frame of a triangle; the first column along its first side.
Eigen::Matrix3d TriangleFrame(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                              const Eigen::Vector3d& c) {
  Eigen::Matrix3d frame;
  frame.col(0) = (b - a).normalized();
  frame.col(2) = (b - a).cross(c - a).normalized();
  frame.col(1) = frame.col(2).cross(frame.col(0));
  return frame;
}

/// Real roots, double ones included: a triangle with two equal sides, seen symmetrically, has one.
std::vector<double> RootsOfQuartic(const double (&c)[5]) {
  const RealRoots simple = FindRealRoots(c, 4);
  std::vector<double> roots(simple.begin(), simple.end());
  const double derivative[4] = {c[1], 2 * c[2], 3 * c[3], 4 * c[4]};
  for (const double x : FindRealRoots(derivative, 3)) {
    double value = 0, magnitude = 0;
    for (int i = 4; i >= 0; --i) {
      value = value * x + c[i];
      magnitude = magnitude * std::abs(x) + std::abs(c[i]);
    }
    constexpr double kRounding = 1e-12;
    if (std::abs(value) < kRounding * magnitude) roots.push_back(x);
  }
  return roots;
}

}  // namespace

std::vector<SE3> SolveP3p(const std::array<Eigen::Vector3d, 3>& points_in_world,
                          const std::array<Eigen::Vector2d, 3>& rays) {
  std::vector<SE3> poses;
  const auto& p = points_in_world;
  // Squared sides over the largest of them, so that the unknown distances s are of that unit.
  double d12 = (p[0] - p[1]).squaredNorm(), d13 = (p[0] - p[2]).squaredNorm(),
         d23 = (p[1] - p[2]).squaredNorm();
  const double unit2 = std::max({d12, d13, d23});
  const double area2 = (p[1] - p[0]).cross(p[2] - p[0]).squaredNorm();
  if (!std::isfinite(unit2) || !(area2 > 1e-8 * unit2 * unit2)) return poses;
  d12 /= unit2, d13 /= unit2, d23 /= unit2;
  std::array<Eigen::Vector3d, 3> f;
  for (int i = 0; i < 3; ++i) f[i] = rays[i].homogeneous().normalized();
  const double c12 = f[0].dot(f[1]), c13 = f[0].dot(f[2]), c23 = f[1].dot(f[2]);
  if (!std::isfinite(c12 + c13 + c23)) return poses;

  // With u = s2 / s1 and v = s3 / s1, the law of cosines gives two equations, quadratic in u:
  //   (d12 - d23) u^2 + 2 (c12 d23 - c23 d12 v) u + d12 v^2 - d23 = 0
  //   -d13 u^2 + 2 c12 d13 u + d12 (1 + v^2 - 2 c13 v) - d13 = 0
  // Their combination without u^2 is linear in u: u = -n(v) / m(v), with n quadratic in v.
  const double q[3] = {d12 - d13, -2 * c13 * d12, d12};  // of the second, without u
  const double n[3] = {-d13 * d23 + (d12 - d23) * q[0], (d12 - d23) * q[1],
                       d13 * d12 + (d12 - d23) * q[2]};
  const double m[2] = {2 * c12 * d13 * d23 + 2 * c12 * d13 * (d12 - d23), -2 * c23 * d12 * d13};
  // Into the second: -d13 n^2 - 2 c12 d13 n m + q m^2 = 0.
  double quartic[5] = {};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) quartic[i + j] -= d13 * n[i] * n[j];
    for (int j = 0; j < 2; ++j) {
      quartic[i + j] -= 2 * c12 * d13 * n[i] * m[j];
      for (int k = 0; k < 2; ++k) quartic[i + j + k] += q[i] * m[j] * m[k];
    }
  }
  const Eigen::Matrix3d world_frame = TriangleFrame(p[0], p[1], p[2]);
  std::vector<Eigen::Vector3d> distances;
  for (const double v : RootsOfQuartic(quartic)) {
    if (!(v > 0)) continue;
    const double denominator = m[0] + m[1] * v;
    double u[2];
    int num_u = 1;
    // A double root is known to half the digits only, and so is a denominator that is 0 there.
    if (std::abs(denominator) > 1e-6) {
      u[0] = -(n[0] + n[1] * v + n[2] * v * v) / denominator;
    } else {
      // Both equations are the same in u there, and both of its roots count.
      const double half = c12 * c12 + (q[0] + q[1] * v + q[2] * v * v) / d13;
      if (half < 0) continue;
      u[0] = c12 + std::sqrt(half);
      u[1] = c12 - std::sqrt(half);
      num_u = 2;
    }
    for (int i = 0; i < num_u; ++i) {
      const double s1_squared = d13 / (1 + v * v - 2 * v * c13);
      if (!(u[i] > 0) || !(s1_squared > 0)) continue;
      Eigen::Vector3d s = std::sqrt(s1_squared) * Eigen::Vector3d(1, u[i], v);
      const auto error_at = [&](const Eigen::Vector3d& x) {
        return Eigen::Vector3d(x[0] * x[0] + x[1] * x[1] - 2 * x[0] * x[1] * c12 - d12,
                               x[0] * x[0] + x[2] * x[2] - 2 * x[0] * x[2] * c13 - d13,
                               x[1] * x[1] + x[2] * x[2] - 2 * x[1] * x[2] * c23 - d23);
      };
      for (int k = 0; k < 5; ++k) {
        const Eigen::Vector3d error = error_at(s);
        Eigen::Matrix3d j;
        j << s[0] - s[1] * c12, s[1] - s[0] * c12, 0,  //
            s[0] - s[2] * c13, 0, s[2] - s[0] * c13,   //
            0, s[1] - s[2] * c23, s[2] - s[1] * c23;
        const Eigen::Vector3d step = -0.5 * j.inverse() * error;
        // Near the danger cylinder j is singular: what the quartic says has to do.
        if (!step.allFinite() || step.norm() > 0.1 * s.norm()) break;
        s += step;
      }
      constexpr double kFits = 1e-7, kSame = 1e-5;
      if (!(s.minCoeff() > 0) || !(error_at(s).norm() < kFits)) continue;
      const bool known = std::any_of(distances.begin(), distances.end(), [&](const auto& other) {
        return (other - s).norm() < kSame * s.norm();
      });
      if (known) continue;
      distances.push_back(s);
      s *= std::sqrt(unit2);
      const Eigen::Matrix3d rotation =
          TriangleFrame(s[0] * f[0], s[1] * f[1], s[2] * f[2]) * world_frame.transpose();
      const Eigen::Vector3d t = s[0] * f[0] - rotation * p[0];
      if (rotation.allFinite() && t.allFinite()) poses.emplace_back(rotation, t);
    }
  }
  return poses;
}

}  // namespace vpslam
