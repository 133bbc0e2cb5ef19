#include "core/estimation/linear_translation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>

#include "core/estimation/point_residual.h"
#include "core/geometry/chi_square.h"
#include "core/geometry/random_sample.h"

namespace vpslam {
namespace {

struct Row {
  Eigen::Vector3d rotated;  ///< R X
  Eigen::Vector2d ray;      ///< at z = 1
  const PointMeasurement* measurement;
};

class NormalEquations {
 public:
  /// `weight` is the square root of the information of the row's two equations.
  void Add(const Row& row, const Eigen::Matrix2d& weight) {
    Eigen::Matrix<double, 2, 3> a;
    a << -1, 0, row.ray.x(), 0, -1, row.ray.y();
    a = weight * a;
    const Eigen::Vector2d b = weight * (row.rotated.head<2>() - row.rotated.z() * row.ray);
    h_ += a.transpose() * a;
    g_ += a.transpose() * b;
    ++count_;
    rays_ += row.ray;
    squared_rays_ += row.ray.squaredNorm();
  }
  Eigen::Vector3d Solve() const { return h_.ldlt().solve(g_); }
  /// Of the rays about their mean. Where there is none, the translation along them is open.
  double RaySpread_rad() const {
    return std::sqrt(std::max(0.0, squared_rays_ / count_ - (rays_ / count_).squaredNorm()));
  }

 private:
  Eigen::Matrix3d h_ = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g_ = Eigen::Vector3d::Zero();
  int count_ = 0;
  Eigen::Vector2d rays_ = Eigen::Vector2d::Zero();
  double squared_rays_ = 0;
};

Eigen::Matrix2d Weight(const Row& row, const Eigen::Vector3d& t, TranslationWeights weights) {
  if (weights == TranslationWeights::kNone) return Eigen::Matrix2d::Identity();
  const double depth = std::max(kMinDepth, row.rotated.z() + t.z());
  return row.measurement->sqrt_information / depth;
}

std::vector<const Row*> Inliers(const Camera& camera, const std::vector<Row>& rows,
                                const Eigen::Vector3d& t) {
  std::vector<const Row*> inliers;
  for (const Row& row : rows) {
    const Eigen::Vector3d x = row.rotated + t;
    if (x.z() < kMinDepth) continue;
    const Eigen::Vector2d error_px = camera.Project(x) - row.measurement->px;
    if ((row.measurement->sqrt_information * error_px).squaredNorm() <= kChi2Dof2) {
      inliers.push_back(&row);
    }
  }
  return inliers;
}

}  // namespace

std::optional<Eigen::Vector3d> EstimateTranslation(const Camera& camera,
                                                   std::span<const PointMeasurement> points,
                                                   const Eigen::Quaterniond& cam_from_world,
                                                   TranslationWeights weights, int min_inliers,
                                                   std::mt19937_64& rng) {
  if (points.size() < 2 || static_cast<int>(points.size()) < min_inliers) return std::nullopt;
  std::vector<Row> rows;
  rows.reserve(points.size());
  for (const PointMeasurement& m : points) {
    rows.push_back({cam_from_world * m.point_in_world, camera.Unproject(m.px).head<2>(), &m});
  }
  constexpr int kSamples = 50;  // 99.99 % sure to draw two good ones of which half are bad
  std::vector<const Row*> best;
  const int size = static_cast<int>(rows.size());
  for (int i = 0; i < kSamples; ++i) {
    NormalEquations sample;
    sample.Add(rows[RandomIndex(size, rng)], Eigen::Matrix2d::Identity());
    sample.Add(rows[RandomIndex(size, rng)], Eigen::Matrix2d::Identity());
    const Eigen::Vector3d t = sample.Solve();
    if (!t.allFinite()) continue;
    std::vector<const Row*> inliers = Inliers(camera, rows, t);
    if (inliers.size() > best.size()) best = std::move(inliers);
  }
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  const int rounds = weights == TranslationWeights::kNone ? 1 : 2;
  for (int round = 0; round <= rounds; ++round) {
    if (static_cast<int>(best.size()) < min_inliers) return std::nullopt;
    NormalEquations all;
    for (const Row* row : best) {
      all.Add(*row, Weight(*row, t, round == 0 ? TranslationWeights::kNone : weights));
    }
    constexpr double kMinRaySpread_rad = 0.01;  // in less it would be noise that tells how far
    if (!(all.RaySpread_rad() >= kMinRaySpread_rad)) return std::nullopt;
    t = all.Solve();
    if (!t.allFinite()) return std::nullopt;
    best = Inliers(camera, rows, t);
  }
  return t;
}

}  // namespace vpslam
