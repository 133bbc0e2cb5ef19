#include "core/geometry/pnp.h"

#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>

#include "core/geometry/chi_square.h"
#include "core/geometry/p3p.h"
#include "core/geometry/random_sample.h"

namespace vpslam {
namespace {

double Chi2(const Camera& camera, const SE3& pose, const PnpMatch& match) {
  const Eigen::Vector3d x = pose * match.point_in_world;
  if (!(x.z() > 0)) return std::numeric_limits<double>::infinity();
  return (camera.Project(x) - match.position_px).squaredNorm() / (match.sigma_px * match.sigma_px);
}

/// Sum of max(0, 5.991 - chi2).
double Score(const Camera& camera, std::span<const PnpMatch> matches, const SE3& pose) {
  const Eigen::Matrix3d rotation = pose.RotationMatrix();
  double score = 0;
  for (const PnpMatch& match : matches) {
    const Eigen::Vector3d x = rotation * match.point_in_world + pose.translation;
    if (!(x.z() > 0)) continue;
    const double chi2 =
        (camera.Project(x) - match.position_px).squaredNorm() / (match.sigma_px * match.sigma_px);
    if (chi2 < kChi2Dof2) score += kChi2Dof2 - chi2;
  }
  return score;
}

/// Sum of Huber's losses and its Gauss-Newton system by the perturbation of Retract(); returns the
/// number of points in front of the camera.
int Linearise(const Camera& camera, std::span<const PnpMatch> matches, const SE3& pose,
              double* cost, Matrix6d* h, Vector6d* g) {
  const Eigen::Matrix3d rotation = pose.RotationMatrix();
  *cost = 0;
  if (h) h->setZero(), g->setZero();
  int num_in_front = 0;
  for (const PnpMatch& match : matches) {
    const Eigen::Vector3d x = rotation * match.point_in_world + pose.translation;
    if (!(x.z() > 0)) {
      // As the loss of a match 10 thresholds off: or a step across the image plane would pay.
      *cost += 19 * kChi2Dof2;
      continue;
    }
    ++num_in_front;
    const Eigen::Vector2d error = (camera.Project(x) - match.position_px) / match.sigma_px;
    const double chi2 = error.squaredNorm();
    double weight = 1;
    if (chi2 > kChi2Dof2) {
      weight = std::sqrt(kChi2Dof2 / chi2);
      *cost += 2 * std::sqrt(kChi2Dof2 * chi2) - kChi2Dof2;
    } else {
      *cost += chi2;
    }
    if (!h) continue;
    const double inverse_z = 1 / x.z();
    const double a = camera.fx * inverse_z / match.sigma_px;
    const double b = camera.fy * inverse_z / match.sigma_px;
    Eigen::Matrix<double, 2, 3> by_point;
    by_point << a, 0, -a * x.x() * inverse_z, 0, b, -b * x.y() * inverse_z;
    Eigen::Matrix<double, 2, 6> j;
    j.leftCols<3>() = by_point;
    j.rightCols<3>() = -by_point * Skew(x);
    *h += weight * j.transpose() * j;
    *g += weight * j.transpose() * error;
  }
  return num_in_front;
}

bool IsUsable(const PnpMatch& match) {
  return match.point_in_world.allFinite() && match.position_px.allFinite() &&
         std::isfinite(match.sigma_px) && match.sigma_px > 0;
}

std::vector<PnpMatch> Inliers(const Camera& camera, std::span<const PnpMatch> matches,
                              const SE3& pose) {
  std::vector<PnpMatch> inliers;
  for (const PnpMatch& match : matches) {
    if (Chi2(camera, pose, match) < kChi2Dof2) inliers.push_back(match);
  }
  return inliers;
}

}  // namespace

std::optional<std::string> PnpOptions::Validate() const {
  if (min_inliers < 4) return "min_inliers must be at least 4";
  return ransac.Validate();
}

bool RefinePose(const Camera& camera, std::span<const PnpMatch> matches, int max_iterations,
                SE3* cam_from_world) {
  SE3& pose = *cam_from_world;
  Matrix6d h;
  Vector6d g;
  double cost;
  if (Linearise(camera, matches, pose, &cost, &h, &g) < 3) return false;
  double damping = 1e-6;
  for (int i = 0; i < max_iterations; ++i) {
    Matrix6d damped = h;
    damped.diagonal() *= 1 + damping;
    const Vector6d step = damped.ldlt().solve(-g);
    if (!step.allFinite()) break;
    const SE3 moved = Retract(pose, step);
    double moved_cost;
    Linearise(camera, matches, moved, &moved_cost, nullptr, nullptr);
    if (moved_cost < cost) {
      const bool converged = cost - moved_cost < 1e-9 * cost;
      pose = moved;
      Linearise(camera, matches, pose, &cost, &h, &g);
      damping *= 0.1;
      if (converged) break;
    } else {
      damping = std::max(1e-4, 10 * damping);
      if (damping > 1e6) break;
    }
  }
  return true;
}

std::optional<PnpResult> EstimatePnp(const Camera& camera, std::span<const PnpMatch> matches,
                                     const PnpOptions& options, std::mt19937_64& rng) {
  std::vector<PnpMatch> usable;
  for (const PnpMatch& match : matches) {
    if (IsUsable(match)) usable.push_back(match);
  }
  const int n = static_cast<int>(usable.size());
  if (n < options.min_inliers) return std::nullopt;
  SE3 best;
  double best_score = 0;
  int required = options.ransac.max_iterations;
  for (int iteration = 0; iteration < required; ++iteration) {
    const std::array<int, 4> sample = RandomSample<4>(n, rng);
    std::array<Eigen::Vector3d, 3> points;
    std::array<Eigen::Vector2d, 3> rays;
    for (int k = 0; k < 3; ++k) {
      points[k] = usable[sample[k]].point_in_world;
      rays[k] = camera.Unproject(usable[sample[k]].position_px).head<2>();
    }
    SE3 hypothesis;
    // The fourth match decides, within reason: the three hardly know its direction.
    constexpr double kMaxFourthChi2 = 100;
    double fourth_chi2 = kMaxFourthChi2;
    for (const SE3& pose : SolveP3p(points, rays)) {
      const double chi2 = Chi2(camera, pose, usable[sample[3]]);
      if (chi2 < fourth_chi2) {
        fourth_chi2 = chi2;
        hypothesis = pose;
      }
    }
    if (fourth_chi2 == kMaxFourthChi2) continue;
    if (Score(camera, usable, hypothesis) <= 0.8 * best_score) continue;
    constexpr int kLocalIterations = 4;
    for (int round = 0; round < 2; ++round) {
      const std::vector<PnpMatch> inliers = Inliers(camera, usable, hypothesis);
      if (inliers.size() >= 4) RefinePose(camera, inliers, kLocalIterations, &hypothesis);
    }
    const double score = Score(camera, usable, hypothesis);
    if (score <= best_score) continue;
    best_score = score;
    best = hypothesis;
    const double share = static_cast<double>(Inliers(camera, usable, best).size()) / n;
    required = RequiredIterations(options.ransac, share, 4);
  }
  if (best_score == 0) return std::nullopt;
  // To convergence; the set of inliers settles within a few rounds.
  for (int round = 0; round < 3; ++round) {
    const std::vector<PnpMatch> inliers = Inliers(camera, usable, best);
    if (inliers.size() < 4 || !RefinePose(camera, inliers, 10, &best)) return std::nullopt;
  }
  PnpResult result;
  result.cam_from_world = best;
  for (const PnpMatch& match : matches) {
    result.inlier.push_back(IsUsable(match) && Chi2(camera, best, match) < kChi2Dof2);
    result.num_inliers += result.inlier.back();
  }
  if (result.num_inliers < options.min_inliers) return std::nullopt;
  return result;
}

}  // namespace vpslam
