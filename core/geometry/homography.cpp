#include "core/geometry/homography.h"

#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Dense>

#include "core/geometry/chi_square.h"
#include "core/geometry/random_sample.h"

namespace vpslam {
namespace {

using Vector8d = Eigen::Matrix<double, 8, 1>;
using Matrix8d = Eigen::Matrix<double, 8, 8>;

/// Columns are the first three points, scaled so that the fourth is their sum; nullopt if three of
/// the four are nearly on a line.
std::optional<Eigen::Matrix3d> ProjectiveBasis(const std::array<Eigen::Vector2d, 4>& x,
                                               Eigen::Vector3d* scale) {
  Eigen::Matrix3d m;
  for (int k = 0; k < 3; ++k) m.col(k) = x[k].homogeneous();
  // Determinants are twice the areas of the triangles: 1e-5 is about a triangle of 4 px x 0.7 f.
  constexpr double kMinArea = 1e-5;
  if (!(std::abs(m.determinant()) > kMinArea)) return std::nullopt;
  const double determinant = m.determinant();
  *scale = m.inverse() * x[3].homogeneous();
  if (!((*scale * determinant).cwiseAbs().minCoeff() > kMinArea)) return std::nullopt;
  return Eigen::Matrix3d(m * scale->asDiagonal());
}

double TruncatedCost(const Eigen::Matrix3d& h, std::span<const RayMatch> matches, double max_chi2) {
  double cost = 0;
  for (const RayMatch& match : matches) {
    const double chi2 = TransferChi2(h, match);
    cost += chi2 < max_chi2 ? chi2 : max_chi2;
  }
  return cost;
}

}  // namespace

std::optional<Eigen::Matrix3d> SolveFourPoint(const std::array<Eigen::Vector2d, 4>& first,
                                              const std::array<Eigen::Vector2d, 4>& second) {
  Eigen::Vector3d scale_1, scale_2;
  const auto basis_1 = ProjectiveBasis(first, &scale_1);
  const auto basis_2 = ProjectiveBasis(second, &scale_2);
  if (!basis_1 || !basis_2) return std::nullopt;
  // The third homogeneous coordinate of H x must have the same sign at all four points.
  const Eigen::Vector3d depth = scale_2.cwiseQuotient(scale_1);
  if (!((depth.array() > 0).all() || (depth.array() < 0).all())) return std::nullopt;
  Eigen::Matrix3d h = *basis_2 * basis_1->inverse();
  if (depth[0] < 0) h = -h;
  if (!h.allFinite()) return std::nullopt;
  return Eigen::Matrix3d(h / h.norm());
}

double TransferChi2(const Eigen::Matrix3d& h, const RayMatch& m) {
  const Eigen::Vector3d x = h * m.first.homogeneous();
  const Eigen::Vector2d error = x.head<2>() / x.z() - m.second;
  return error.cwiseAbs2().dot((m.first_variance + m.second_variance).cwiseInverse());
}

double HomographyScore(const Eigen::Matrix3d& homography, std::span<const RayMatch> matches,
                       double to_beat) {
  const Eigen::Matrix3d inverse = homography.inverse();
  double score = 0, reachable = 2 * kChi2Dof2 * static_cast<double>(matches.size());
  for (const RayMatch& match : matches) {
    const double forward = TransferChi2(homography, match);
    const double backward = TransferChi2(
        inverse, {match.second, match.first, match.second_variance, match.first_variance});
    for (const double chi2 : {forward, backward}) {
      if (chi2 < kChi2Dof2) {
        score += kChi2Dof2 - chi2;
        reachable -= chi2;
      } else {
        reachable -= kChi2Dof2;
      }
    }
    if (reachable <= to_beat) return 0;
  }
  return score > to_beat ? score : 0;
}

void RefineHomography(std::span<const RayMatch> matches, int max_iterations, double max_chi2,
                      Eigen::Matrix3d* homography) {
  Eigen::Matrix3d& h = *homography;
  double cost = TruncatedCost(h, matches, max_chi2);
  double damping = 1e-4;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    // H' = (I + D) H with D(2,2) = 0.
    Matrix8d normal = Matrix8d::Zero();
    Vector8d gradient = Vector8d::Zero();
    for (const RayMatch& m : matches) {
      const Eigen::Vector3d x = h * m.first.homogeneous();
      const Eigen::Vector2d projected = x.head<2>() / x.z();
      const Eigen::Vector2d error = projected - m.second;
      const Eigen::Vector2d weight = (m.first_variance + m.second_variance).cwiseInverse();
      if (!(error.cwiseAbs2().dot(weight) < max_chi2)) continue;
      const Eigen::Vector3d y = projected.homogeneous();
      Vector8d jx, jy;
      jx << y, Eigen::Vector3d::Zero(), -projected.x() * y.head<2>();
      jy << Eigen::Vector3d::Zero(), y, -projected.y() * y.head<2>();
      normal.selfadjointView<Eigen::Lower>().rankUpdate(jx, weight.x());
      normal.selfadjointView<Eigen::Lower>().rankUpdate(jy, weight.y());
      gradient += weight.x() * error.x() * jx + weight.y() * error.y() * jy;
    }
    normal.diagonal() *= 1 + damping;
    const Vector8d step = normal.selfadjointView<Eigen::Lower>().ldlt().solve(-gradient);
    if (!step.allFinite()) return;
    Eigen::Matrix3d d;
    d << step[0], step[1], step[2], step[3], step[4], step[5], step[6], step[7], 0;
    Eigen::Matrix3d moved = h + d * h;
    moved /= moved.norm();
    const double moved_cost = TruncatedCost(moved, matches, max_chi2);
    if (moved_cost < cost) {
      const bool converged = cost - moved_cost < 1e-6 * cost;
      h = moved;
      cost = moved_cost;
      damping *= 0.1;
      if (converged) return;
    } else {
      damping *= 10;
      if (damping > 1e4) return;
    }
  }
}

HomographyEstimate EstimateHomography(std::span<const RayMatch> matches,
                                      const RansacOptions& options, std::mt19937_64& rng) {
  HomographyEstimate best;
  const int n = static_cast<int>(matches.size());
  if (n < 4) return best;
  int required = options.max_iterations;
  for (; best.iterations < required; ++best.iterations) {
    std::array<Eigen::Vector2d, 4> first, second;
    const std::array<int, 4> sample = RandomSample<4>(n, rng);
    for (int k = 0; k < 4; ++k) {
      first[k] = matches[sample[k]].first;
      second[k] = matches[sample[k]].second;
    }
    const auto hypothesis = SolveFourPoint(first, second);
    if (!hypothesis) continue;
    // Local optimisation can add to a model, so one slightly below the best deserves it as well.
    constexpr double kWorthOptimising = 0.9;
    if (HomographyScore(*hypothesis, matches, kWorthOptimising * best.score) == 0) continue;
    Eigen::Matrix3d h = *hypothesis;
    // First with a wider gate: a rough start excludes many true matches.
    RefineHomography(matches, 3, 3 * kChi2Dof2, &h);
    RefineHomography(matches, 3, kChi2Dof2, &h);
    const double score = HomographyScore(h, matches, best.score);
    if (score > 0) {
      best.score = score;
      best.homography = h;
      int inliers = 0;
      for (const RayMatch& match : matches) inliers += TransferChi2(h, match) < kChi2Dof2;
      required = RequiredIterations(options, static_cast<double>(inliers) / n, 4);
    }
  }
  return best;
}

std::vector<SE3> DecomposeHomography(const Eigen::Matrix3d& homography, double min_translation) {
  std::vector<SE3> motions;
  if (!homography.allFinite()) return motions;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(homography, Eigen::ComputeFullV);
  const double middle = svd.singularValues()[1];
  if (!(middle > 0)) return motions;
  Eigen::Matrix3d h = homography / middle;
  if (h.determinant() < 0) h = -h;
  const double s1 = svd.singularValues()[0] / middle, s3 = svd.singularValues()[2] / middle;
  // s1 - s3 = |t| |n| in these units, so this is where the translation vanishes.
  if (!(s1 - s3 > min_translation)) return motions;
  Eigen::Matrix3d v = svd.matrixV();
  if (v.determinant() < 0) v = -v;
  const double denominator = std::sqrt((s1 - s3) * (s1 + s3));
  const double a = std::sqrt(std::max(0.0, (1 - s3) * (1 + s3))) / denominator;
  const double b = std::sqrt(std::max(0.0, (s1 - 1) * (s1 + 1))) / denominator;
  // Two directions, with v2, of planes in which H keeps all lengths: there H acts as R.
  for (const double sign : {1.0, -1.0}) {
    const Eigen::Vector3d u = a * v.col(0) + sign * b * v.col(2);
    Eigen::Matrix3d from, to;
    from << v.col(1), u, v.col(1).cross(u);
    to.col(0) = h * v.col(1);
    to.col(1) = h * u;
    to.col(2) = to.col(0).cross(to.col(1));
    const Eigen::Matrix3d rotation = to * from.transpose();
    const Eigen::Vector3d t = (h - rotation) * from.col(2);
    if (!(t.norm() > 0)) continue;
    motions.emplace_back(rotation, t.normalized());
    motions.emplace_back(rotation, -t.normalized());
  }
  return motions;
}

}  // namespace vpslam
