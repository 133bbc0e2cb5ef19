#include "core/geometry/essential.h"

#include <cmath>

#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>

#include "core/geometry/chi_square.h"
#include "core/geometry/motion_refinement.h"
#include "core/geometry/polynomial.h"
#include "core/geometry/random_sample.h"

namespace vpslam {
namespace {

// Polynomials in (x, y, z), as rows of coefficients.
using Linear = Eigen::Matrix<double, 1, 4>;      // x y z 1
using Quadratic = Eigen::Matrix<double, 1, 10>;  // xx xy yy xz yz zz x y z 1
// In the order of [Nis04]: x3 y3 x2y xy2 x2z x2 y2z y2 xyz xy | xz2 xz x yz2 yz y z3 z2 z 1.
using Cubic = Eigen::Matrix<double, 1, 20>;

Quadratic Product2(const Linear& p, const Linear& q) {
  Quadratic r;
  r << p[0] * q[0], p[0] * q[1] + p[1] * q[0], p[1] * q[1], p[0] * q[2] + p[2] * q[0],
      p[1] * q[2] + p[2] * q[1], p[2] * q[2], p[0] * q[3] + p[3] * q[0], p[1] * q[3] + p[3] * q[1],
      p[2] * q[3] + p[3] * q[2], p[3] * q[3];
  return r;
}

Cubic Product3(const Quadratic& q, const Linear& p) {
  const double a = p[0], b = p[1], c = p[2], d = p[3];
  Cubic r;
  r << q[0] * a, q[2] * b, q[0] * b + q[1] * a, q[1] * b + q[2] * a, q[0] * c + q[3] * a,
      q[0] * d + q[6] * a, q[2] * c + q[4] * b, q[2] * d + q[7] * b, q[1] * c + q[3] * b + q[4] * a,
      q[1] * d + q[6] * b + q[7] * a, q[3] * c + q[5] * a, q[3] * d + q[6] * c + q[8] * a,
      q[6] * d + q[9] * a, q[4] * c + q[5] * b, q[4] * d + q[7] * c + q[8] * b, q[7] * d + q[9] * b,
      q[5] * c, q[5] * d + q[8] * c, q[8] * d + q[9] * c, q[9] * d;
  return r;
}

/// c += sign a b, coefficients in ascending order.
template <size_t A, size_t B, size_t C>
void MultiplyAdd(const std::array<double, A>& a, const std::array<double, B>& b, double sign,
                 std::array<double, C>* c) {
  static_assert(A + B - 1 <= C);
  for (size_t i = 0; i < A; ++i) {
    for (size_t j = 0; j < B; ++j) (*c)[i + j] += sign * a[i] * b[j];
  }
}

double Evaluate(const double* c, int degree, double z) {
  double value = c[degree];
  for (int i = degree - 1; i >= 0; --i) value = value * z + c[i];
  return value;
}

}  // namespace

std::vector<Eigen::Matrix3d> SolveFivePoint(const std::array<Eigen::Vector2d, 5>& first,
                                            const std::array<Eigen::Vector2d, 5>& second) {
  std::vector<Eigen::Matrix3d> solutions;
  // E = x X + y Y + z Z + W, where X to W span the null space of the five linear constraints.
  Eigen::Matrix<double, 9, 5> constraints;
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d x1 = first[i].homogeneous(), x2 = second[i].homogeneous();
    const Eigen::Matrix3d outer = x1 * x2.transpose();  // column by column: E row by row
    constraints.col(i) = Eigen::Map<const Eigen::Matrix<double, 9, 1>>(outer.data());
  }
  if (!constraints.allFinite()) return solutions;
  const Eigen::ColPivHouseholderQR<Eigen::Matrix<double, 9, 5>> qr(constraints);
  if (qr.rank() < 5) return solutions;
  Eigen::Matrix<double, 9, 9> q = Eigen::Matrix<double, 9, 9>::Identity();
  q.applyOnTheLeft(qr.householderQ());
  const Eigen::Matrix<double, 9, 4> basis = q.rightCols<4>();
  const auto e = [&basis](int row, int col) -> Linear { return basis.row(3 * row + col); };

  // det E = 0 and (E E^T - tr(E E^T) / 2 I) E = 0.
  Quadratic eet[3][3];
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) {
      eet[i][j] =
          Product2(e(i, 0), e(j, 0)) + Product2(e(i, 1), e(j, 1)) + Product2(e(i, 2), e(j, 2));
      eet[j][i] = eet[i][j];
    }
  }
  const Quadratic half_trace = 0.5 * (eet[0][0] + eet[1][1] + eet[2][2]);
  for (int i = 0; i < 3; ++i) eet[i][i] -= half_trace;
  Eigen::Matrix<double, 10, 20> cubics;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      cubics.row(3 * i + j) = Product3(eet[i][0], e(0, j)) + Product3(eet[i][1], e(1, j)) +
                              Product3(eet[i][2], e(2, j));
    }
  }
  cubics.row(9) = Product3(Product2(e(1, 1), e(2, 2)) - Product2(e(1, 2), e(2, 1)), e(0, 0)) +
                  Product3(Product2(e(1, 2), e(2, 0)) - Product2(e(1, 0), e(2, 2)), e(0, 1)) +
                  Product3(Product2(e(1, 0), e(2, 1)) - Product2(e(1, 1), e(2, 0)), e(0, 2));
  const Eigen::Matrix<double, 10, 10> reduced =
      cubics.leftCols<10>().partialPivLu().solve(cubics.rightCols<10>());
  if (!reduced.allFinite()) return solutions;

  // Rows in pairs, the first less z times the second, leave B(z) (x y 1)^T = 0, with entries of
  // degree 3, 3 and 4 in z.
  std::array<std::array<double, 4>, 3> bx, by;
  std::array<std::array<double, 5>, 3> b1;
  for (int k = 0; k < 3; ++k) {
    const auto u = reduced.row(4 + 2 * k), v = reduced.row(5 + 2 * k);
    bx[k] = {u[2], u[1] - v[2], u[0] - v[1], -v[0]};
    by[k] = {u[5], u[4] - v[5], u[3] - v[4], -v[3]};
    b1[k] = {u[9], u[8] - v[9], u[7] - v[8], u[6] - v[7], -v[6]};
  }
  std::array<double, 11> determinant{};
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3, m = (k + 2) % 3;
    std::array<double, 7> minor{};  // of b1[k]
    MultiplyAdd(bx[l], by[m], 1, &minor);
    MultiplyAdd(bx[m], by[l], -1, &minor);
    MultiplyAdd(minor, b1[k], 1, &determinant);
  }
  for (const double z : FindRealRoots(determinant.data(), 10)) {
    Eigen::Matrix3d b;
    for (int k = 0; k < 3; ++k) {
      b.row(k) << Evaluate(bx[k].data(), 3, z), Evaluate(by[k].data(), 3, z),
          Evaluate(b1[k].data(), 4, z);
      b.row(k).normalize();
    }
    // The null vector: of the three cross products of rows the best conditioned.
    Eigen::Vector3d null = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d candidate = b.row(k).transpose().cross(b.row((k + 1) % 3).transpose());
      if (candidate.squaredNorm() > null.squaredNorm()) null = candidate;
    }
    const Eigen::Vector4d coefficients(null.x(), null.y(), z * null.z(), null.z());
    const Eigen::Matrix<double, 9, 1> essential = basis * coefficients.normalized();
    if (!essential.allFinite()) continue;
    solutions.push_back(std::sqrt(2.0) *
                        Eigen::Map<const Eigen::Matrix3d>(essential.data()).transpose());
  }
  return solutions;
}

Eigen::Matrix3d EssentialFromMotion(const SE3& second_from_first) {
  return Skew(second_from_first.translation) * second_from_first.RotationMatrix();
}

std::array<SE3, 4> DecomposeEssential(const Eigen::Matrix3d& essential) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(essential, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU(), v = svd.matrixV();
  if (u.determinant() < 0) u = -u;
  if (v.determinant() < 0) v = -v;
  Eigen::Matrix3d w;
  w << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  const Eigen::Matrix3d a = u * w * v.transpose(), b = u * w.transpose() * v.transpose();
  const Eigen::Vector3d t = u.col(2);
  return {SE3(a, t), SE3(a, -t), SE3(b, t), SE3(b, -t)};
}

double SampsonChi2(const Eigen::Matrix3d& e, const RayMatch& m) {
  const Eigen::Vector3d x1 = m.first.homogeneous(), x2 = m.second.homogeneous();
  const Eigen::Vector3d line_2 = e * x1;
  const Eigen::Vector2d line_1 = e.leftCols<2>().transpose() * x2;
  const double error = x2.dot(line_2);
  const double variance = line_1.cwiseAbs2().dot(m.first_variance) +
                          line_2.head<2>().cwiseAbs2().dot(m.second_variance);
  return error * error / variance;
}

double EssentialScore(const Eigen::Matrix3d& essential, std::span<const RayMatch> matches,
                      double to_beat) {
  double score = 0, reachable = 2 * kChi2Dof2 * static_cast<double>(matches.size());
  for (const RayMatch& match : matches) {
    const double chi2 = SampsonChi2(essential, match);
    if (chi2 < kChi2Dof1) {  // false for NaN: both epipoles on their points
      score += 2 * (kChi2Dof2 - chi2);
      reachable -= 2 * chi2;
    } else {
      reachable -= 2 * kChi2Dof2;
      if (reachable <= to_beat) return 0;
    }
  }
  return score > to_beat ? score : 0;
}

EssentialEstimate EstimateEssential(std::span<const RayMatch> matches, const RansacOptions& options,
                                    std::mt19937_64& rng) {
  EssentialEstimate best;
  const int n = static_cast<int>(matches.size());
  if (n < 5) return best;
  int required = options.max_iterations;
  for (; best.iterations < required; ++best.iterations) {
    std::array<Eigen::Vector2d, 5> first, second;
    const std::array<int, 5> sample = RandomSample<5>(n, rng);
    for (int k = 0; k < 5; ++k) {
      first[k] = matches[sample[k]].first;
      second[k] = matches[sample[k]].second;
    }
    double sample_score = 0;
    Eigen::Matrix3d sample_best;
    // Local optimisation can add to a model, so one slightly below the best deserves it as well.
    constexpr double kWorthOptimising = 0.9;
    for (const Eigen::Matrix3d& e : SolveFivePoint(first, second)) {
      const double score =
          EssentialScore(e, matches, std::max(sample_score, kWorthOptimising * best.score));
      if (score > 0) {
        sample_score = score;
        sample_best = e;
      }
    }
    if (sample_score == 0) continue;
    // Any of the four decompositions will do: they have the same E.
    SE3 motion = DecomposeEssential(sample_best)[0];
    RefineMotionFromAfar(matches, 3, &motion);
    const double score = EssentialScore(EssentialFromMotion(motion), matches);
    if (score > best.score) {
      best.score = score;
      best.motion = motion;
      int inliers = 0;
      const Eigen::Matrix3d e = EssentialFromMotion(motion);
      for (const RayMatch& match : matches) inliers += SampsonChi2(e, match) < kChi2Dof1;
      required = RequiredIterations(options, static_cast<double>(inliers) / n, 5);
    }
  }
  return best;
}

}  // namespace vpslam
