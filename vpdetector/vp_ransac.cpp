#include "vpdetector/vp_ransac.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include <Eigen/Geometry>

namespace vpslam {
namespace {

/// In [0, 1), the same with every standard library.
double Uniform(std::mt19937_64& rng) { return static_cast<double>(rng() >> 11) * 0x1.0p-53; }

/// The lines as columns, in single precision, for a loop that the compiler turns into SIMD.
struct ScoredLines {
  std::vector<float> x, y, z, gain, half_information;

  float Score(const Eigen::Matrix3f& r) const {
    const float ax = r(0, 0), ay = r(1, 0), az = r(2, 0);
    const float bx = r(0, 1), by = r(1, 1), bz = r(2, 1);
    const float cx = r(0, 2), cy = r(1, 2), cz = r(2, 2);
    const size_t n = x.size();
    // Four sums, so that the order of additions is fixed and yet four lanes wide.
    float sum[4] = {0, 0, 0, 0};
    for (size_t i = 0; i < n; i += 4) {
      for (size_t lane = 0; lane < 4; ++lane) {
        const size_t j = i + lane;
        const float a = x[j] * ax + y[j] * ay + z[j] * az;
        const float b = x[j] * bx + y[j] * by + z[j] * bz;
        const float c = x[j] * cx + y[j] * cy + z[j] * cz;
        const float nearest = std::min(std::min(a * a, b * b), c * c);
        sum[lane] += std::max(0.0f, gain[j] - nearest * half_information[j]);
      }
    }
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
  }
};

/// Angle between the two sets of undirected axes, whatever their order: the largest over columns of
/// a of the angle to the nearest of b.
double AxesDifference_rad(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  const Eigen::Matrix3d cosines = (a.transpose() * b).cwiseAbs();
  double smallest = 1;
  for (int i = 0; i < 3; ++i) smallest = std::min(smallest, cosines.row(i).maxCoeff());
  return std::atan2(std::sqrt(std::max(0.0, 1 - smallest * smallest)), smallest);
}

}  // namespace

std::optional<std::string> VpRansacOptions::Validate() const {
  if (num_hypotheses < 1 || num_hypotheses > 1000000) {
    return "num_hypotheses must lie in 1 to 1000000";
  }
  if (num_refined < 1 || num_refined > 1000) return "num_refined must lie in 1 to 1000";
  if (!(min_difference_deg >= 0)) return "min_difference_deg must not be negative";
  if (max_lines < 3) return "max_lines must be at least 3";
  return std::nullopt;
}

std::optional<ManhattanFit> FindManhattan(const std::vector<VpLine>& lines, const VpModel& model,
                                          const VpRansacOptions& options) {
  if (lines.size() < 3) return std::nullopt;
  std::vector<size_t> order(lines.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return lines[a].length_px > lines[b].length_px; });
  order.resize(std::min(order.size(), static_cast<size_t>(options.max_lines)));

  ScoredLines scored;
  std::vector<double> cumulative;
  double sum = 0;
  for (const size_t i : order) {
    const VpLine& line = lines[i];
    const double variance = line.MeanEndPointVariance() + model.WorldVariance();
    scored.x.push_back(static_cast<float>(line.normal.x()));
    scored.y.push_back(static_cast<float>(line.normal.y()));
    scored.z.push_back(static_cast<float>(line.normal.z()));
    scored.gain.push_back(static_cast<float>(line.weight * model.Gain(variance)));
    scored.half_information.push_back(static_cast<float>(line.weight * 0.5 / variance));
    // Longer lines are drawn more often: they are better known and less often clutter.
    sum += line.weight * line.length_px;
    cumulative.push_back(sum);
  }
  while (scored.x.size() % 4 != 0) {
    for (auto* v : {&scored.x, &scored.y, &scored.z, &scored.gain, &scored.half_information}) {
      v->push_back(0);
    }
  }

  std::mt19937_64 rng(options.seed);
  const auto draw = [&]() -> const VpLine& {
    const auto at = std::upper_bound(cumulative.begin(), cumulative.end() - 1, Uniform(rng) * sum);
    return lines[order[static_cast<size_t>(at - cumulative.begin())]];
  };
  struct Hypothesis {
    float score;
    Eigen::Matrix3d r;
  };
  std::vector<Hypothesis> hypotheses;
  hypotheses.reserve(static_cast<size_t>(options.num_hypotheses));
  for (int h = 0; h < options.num_hypotheses; ++h) {
    const Eigen::Vector3d &s0 = draw().normal, &s1 = draw().normal, &s2 = draw().normal;
    Eigen::Matrix3d r;
    r.col(0) = s0.cross(s1);
    const double n0 = r.col(0).norm();
    if (n0 < 0.02) continue;  // about 1 degree apart: the direction would be noise
    r.col(0) /= n0;
    r.col(1) = r.col(0).cross(s2);
    const double n1 = r.col(1).norm();
    if (n1 < 0.02) continue;
    r.col(1) /= n1;
    r.col(2) = r.col(0).cross(r.col(1));
    hypotheses.push_back({scored.Score(r.cast<float>()), r});
  }
  if (hypotheses.empty()) return std::nullopt;
  std::stable_sort(hypotheses.begin(), hypotheses.end(),
                   [](const Hypothesis& a, const Hypothesis& b) { return a.score > b.score; });

  std::optional<ManhattanFit> best;
  std::vector<Eigen::Matrix3d> tried;
  const double min_difference = options.min_difference_deg * std::numbers::pi / 180.0;
  for (const Hypothesis& h : hypotheses) {
    if (static_cast<int>(tried.size()) >= options.num_refined) break;
    const bool known = std::any_of(tried.begin(), tried.end(), [&](const Eigen::Matrix3d& r) {
      return AxesDifference_rad(r, h.r) < min_difference;
    });
    if (known) continue;
    tried.push_back(h.r);
    // A few rounds tell which one is the best; only that one is worth going on with.
    ManhattanFit fit = RefineManhattan(lines, h.r, model, 3);
    if (!best || fit.score > best->score) best = std::move(fit);
  }
  return RefineManhattan(lines, best->cam_from_manhattan, model);
}

}  // namespace vpslam
