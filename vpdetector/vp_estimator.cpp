#include "vpdetector/vp_estimator.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <utility>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "core/geometry/random_sample.h"
#include "core/geometry/so3.h"
#include "core/geometry/sphere.h"
#include "vpdetector/vp_lines.h"

namespace vpslam {
namespace {

/// Logarithm of the probability that of `n` lines `k` or more fit by chance, each with probability
/// `p`.
double LogBinomialTail(int n, int k, double p) {
  if (k <= 0) return 0;
  if (k > n) return -1e9;
  p = std::clamp(p, 1e-9, 1 - 1e-9);
  double tail = 0, first = 0;
  for (int i = k; i <= n; ++i) {
    const double log_term = std::lgamma(n + 1.0) - std::lgamma(i + 1.0) - std::lgamma(n - i + 1.0) +
                            i * std::log(p) + (n - i) * std::log1p(-p);
    if (i == k) first = log_term;
    tail += std::exp(log_term - first);
    if (log_term < first - 40 && i > n * p) break;
  }
  return std::min(0.0, first + std::log(tail));
}

/// Columns of r in the order and with the signs that come closest to the axes of the camera; old
/// column order[k] becomes column k.
std::pair<Eigen::Matrix3d, std::array<int, 3>> NearestToCameraAxes(const Eigen::Matrix3d& r) {
  std::array<int, 3> order{0, 1, 2}, best_order = order;
  Eigen::Matrix3d best = r;
  double best_trace = -4;
  do {
    Eigen::Matrix3d m;
    Eigen::Index weakest = 0;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d d = r.col(order[static_cast<size_t>(k)]);
      m.col(k) = d[k] < 0 ? Eigen::Vector3d(-d) : d;
    }
    if (m.determinant() < 0) {
      m.diagonal().minCoeff(&weakest);
      m.col(weakest) *= -1;
    }
    if (m.trace() > best_trace) {
      best_trace = m.trace();
      best = m;
      best_order = order;
    }
  } while (std::next_permutation(order.begin(), order.end()));
  return {best, best_order};
}

int DistinctLines(const std::vector<int32_t>& group, const std::vector<int32_t>& labels,
                  int32_t label) {
  std::set<int32_t> seen;
  for (size_t i = 0; i < labels.size(); ++i) {
    if (labels[i] == label) seen.insert(group[i]);
  }
  return static_cast<int>(seen.size());
}

/// How likely a random line belongs to a given direction: the width of its gate, on average.
double ChanceOfFit(const std::vector<VpLine>& lines, const VpModel& model) {
  double sum = 0;
  for (const VpLine& line : lines) {
    const double variance = line.MeanEndPointVariance() + model.WorldVariance();
    const double gain = model.Gain(variance);
    if (gain > 0) sum += std::min(1.0, std::sqrt(2 * gain * variance));
  }
  return lines.empty() ? 1.0 : sum / static_cast<double>(lines.size());
}

struct Direction {
  Eigen::Vector3d direction_in_cam = Eigen::Vector3d::UnitZ();
  Eigen::Matrix2d covariance_rad2 = Eigen::Matrix2d::Zero();
  std::vector<size_t> lines;
};

/// The direction that the lines `candidates` support best, by pairs drawn at random and least
/// squares on the sphere.
std::optional<Direction> FindDirection(const std::vector<VpLine>& lines,
                                       const std::vector<size_t>& candidates,
                                       const VpOptions& options, std::mt19937_64& rng) {
  constexpr int kPairs = 100, kRounds = 5;
  const VpModel& model = options.model;
  if (candidates.size() < 2) return std::nullopt;
  // As in FindManhattan, with the variance that a line has on average over directions.
  std::vector<double> gain, half_information;
  for (const size_t i : candidates) {
    const double variance = lines[i].MeanEndPointVariance() + model.WorldVariance();
    gain.push_back(lines[i].weight * model.Gain(variance));
    half_information.push_back(lines[i].weight * 0.5 / variance);
  }
  double best_score = 0;
  Direction best;
  for (int pair = 0; pair < kPairs; ++pair) {
    const auto [i, j] = RandomSample<2>(static_cast<int>(candidates.size()), rng);
    const VpLine& a = lines[candidates[static_cast<size_t>(i)]];
    const VpLine& b = lines[candidates[static_cast<size_t>(j)]];
    const Eigen::Vector3d cross = a.normal.cross(b.normal);
    const double norm = cross.norm();
    if (norm < 0.02) continue;
    const Eigen::Vector3d d = cross / norm;
    double score = 0;
    for (size_t c = 0; c < candidates.size(); ++c) {
      const double distance = lines[candidates[c]].normal.dot(d);
      score += std::max(0.0, gain[c] - half_information[c] * distance * distance);
    }
    if (score > best_score) {
      best_score = score;
      best.direction_in_cam = d;
    }
  }
  if (best_score <= 0) return std::nullopt;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
    double squares = 0, count = 0;
    best.lines.clear();
    for (const size_t i : candidates) {
      const VpLine& line = lines[i];
      const double score = LineScore(line, best.direction_in_cam, model);
      if (score <= 0) continue;
      const double variance = line.EndPointVariance(best.direction_in_cam) + model.WorldVariance();
      const double residual = line.normal.dot(best.direction_in_cam);
      const double information = line.weight * score / model.Gain(variance) / variance;
      h += information * line.normal * line.normal.transpose();
      squares += line.weight * residual * residual / variance;
      count += line.weight;
      best.lines.push_back(i);
    }
    if (best.lines.size() < 2) return std::nullopt;
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(h);
    best.direction_in_cam = solver.eigenvectors().col(0).normalized();
    const double scale =
        (squares + model.prior_lines) / std::max(1.0, count + model.prior_lines - 2.0);
    const Eigen::Matrix<double, 3, 2> basis = TangentBasis(best.direction_in_cam);
    best.covariance_rad2 =
        (basis.transpose() * h * basis / scale + 1e-3 * Eigen::Matrix2d::Identity()).inverse();
  }
  return best;
}

}  // namespace

std::optional<VpMethod> VpMethodFromName(const std::string& name) {
  for (const auto method :
       {VpMethod::kThreeLine, VpMethod::kTwoLineGrid, VpMethod::kTwoLineGridRaw}) {
    if (name == Name(method)) return method;
  }
  return std::nullopt;
}

const char* Name(VpMethod method) {
  switch (method) {
    case VpMethod::kThreeLine:
      return "three_line";
    case VpMethod::kTwoLineGrid:
      return "two_line_grid";
    case VpMethod::kTwoLineGridRaw:
      return "two_line_grid_raw";
  }
  return "?";
}

std::optional<std::string> VpOptions::Validate() const {
  if (const auto why = model.Validate()) return why;
  if (const auto why = ransac.Validate()) return why;
  if (const auto why = grid.Validate()) return why;
  if (!(min_length_px > 0)) return "min_length_px must be positive";
  if (!(same_line_px >= 0)) return "same_line_px must not be negative";
  if (min_support < 2 || min_further_support < 2) {
    return "min_support and min_further_support must be at least 2";
  }
  if (!(max_false_alarms > 0)) return "max_false_alarms must be positive";
  if (!(min_separation_deg >= 0 && min_separation_deg < 90)) {
    return "min_separation_deg must lie in 0 to 90";
  }
  if (max_further < 0 || max_further > 20) return "max_further must lie in 0 to 20";
  return std::nullopt;
}

VpEstimate EstimateVanishingPoints(const std::vector<EdgeSegment>& segments, const Camera& camera,
                                   const VpOptions& options) {
  VpEstimate estimate;
  estimate.labels.assign(segments.size(), -1);
  std::vector<VpLine> lines;
  std::vector<Eigen::Vector2d> starts, ends;
  for (size_t i = 0; i < segments.size(); ++i) {
    const EdgeSegment& s = segments[i];
    auto line = MakeVpLine(camera, s.start_px, s.end_px, s.sigma_px, options.min_length_px);
    if (!line) continue;
    line->source = static_cast<int32_t>(i);
    lines.push_back(*line);
    starts.push_back(s.start_px);
    ends.push_back(s.end_px);
  }
  const std::vector<int32_t> group = GroupByInfiniteLine(starts, ends, options.same_line_px);
  {
    // n segments of one line share part of their errors: they weigh as sqrt(n) together.
    std::vector<int> members(lines.size(), 0);
    for (const int32_t g : group) ++members[static_cast<size_t>(g)];
    for (size_t i = 0; i < lines.size(); ++i) {
      lines[i].weight = 1.0 / std::sqrt(members[static_cast<size_t>(group[i])]);
    }
  }

  // The three axes.
  std::optional<ManhattanFit> fit;
  double chance = ChanceOfFit(lines, options.model);
  if (options.method == VpMethod::kThreeLine) {
    fit = FindManhattan(lines, options.model, options.ransac);
  } else if (const auto found = SearchTwoLineGrid(lines, options.grid)) {
    chance = options.grid.label_deg / 90.0;
    fit = FitLabelledLines(lines, found->labels, found->cam_from_manhattan, options.model);
    if (options.method == VpMethod::kTwoLineGridRaw) {
      fit->cam_from_manhattan = found->cam_from_manhattan;
      // Its cells and steps are one degree wide.
      const double step_rad = std::numbers::pi / 180.0;
      fit->covariance_rad2 += 0.25 * step_rad * step_rad * Eigen::Matrix3d::Identity();
    }
  }
  std::vector<int32_t> labels(lines.size(), -1);
  std::array<int, 3> support{};
  if (fit) {
    // Into a fixed order, so that like images give like answers.
    const auto [r, order] = NearestToCameraAxes(fit->cam_from_manhattan);
    std::array<int32_t, 3> new_label{};
    for (int32_t k = 0; k < 3; ++k)
      new_label[static_cast<size_t>(order[static_cast<size_t>(k)])] = k;
    for (int32_t& label : fit->labels) {
      if (label >= 0) label = new_label[static_cast<size_t>(label)];
    }
    fit->cam_from_manhattan = r;
    labels = fit->labels;

    // How many of the axes does the image carry? From the best supported one down: the first could
    // have been any pair's intersection, the second any line's with the plane at right angles to
    // the first, the third has no freedom left.
    std::array<int32_t, 3> by_support{0, 1, 2};
    for (int32_t k = 0; k < 3; ++k) {
      support[static_cast<size_t>(k)] = DistinctLines(group, labels, k);
    }
    std::stable_sort(by_support.begin(), by_support.end(), [&](int32_t a, int32_t b) {
      return support[static_cast<size_t>(a)] > support[static_cast<size_t>(b)];
    });
    std::set<int32_t> groups(group.begin(), group.end());
    int remaining = static_cast<int>(groups.size());
    const double n = remaining;
    const std::array<double, 3> log_tests{std::log(std::max(1.0, 0.5 * n * (n - 1))), std::log(n),
                                          0.0};
    int seen = 0;
    for (size_t i = 0; i < 3; ++i) {
      const int count = support[static_cast<size_t>(by_support[i])];
      const double log_alarms = log_tests[i] + LogBinomialTail(remaining, count, chance);
      if (count < options.min_support || log_alarms > std::log(options.max_false_alarms)) break;
      remaining = std::max(0, remaining - count);
      ++seen;
    }
    estimate.state = seen == 3   ? ManhattanState::kThree
                     : seen == 2 ? ManhattanState::kTwo
                                 : ManhattanState::kNone;
    if (estimate.state == ManhattanState::kTwo) {
      // What fits the unseen axis does so by chance and shall not pull.
      for (int32_t& label : labels) {
        if (label == by_support[2]) label = -1;
      }
      support[static_cast<size_t>(by_support[2])] = 0;
      if (options.method != VpMethod::kTwoLineGridRaw) {
        fit = FitLabelledLines(lines, labels, fit->cam_from_manhattan, options.model);
      }
    }
    estimate.cam_from_manhattan = fit->cam_from_manhattan;
    estimate.covariance_rad2 = fit->covariance_rad2;
  } else {
    const double quarter_turn = 0.5 * std::numbers::pi;
    estimate.covariance_rad2 = quarter_turn * quarter_turn * Eigen::Matrix3d::Identity();
  }
  if (estimate.state == ManhattanState::kNone) {
    std::fill(labels.begin(), labels.end(), -1);
  } else {
    for (int k = 0; k < 3; ++k) {
      VanishingPoint vp;
      vp.direction_in_cam = estimate.cam_from_manhattan.col(k);
      // The direction moves by w x d.
      const Eigen::Matrix<double, 2, 3> tangent_from_rotation =
          -TangentBasis(vp.direction_in_cam).transpose() * Skew(vp.direction_in_cam);
      vp.covariance_rad2 =
          tangent_from_rotation * estimate.covariance_rad2 * tangent_from_rotation.transpose();
      vp.support = support[static_cast<size_t>(k)];
      estimate.vanishing_points.push_back(vp);
    }
  }

  // Further directions among what is left.
  std::mt19937_64 rng(options.ransac.seed);
  const double further_chance = ChanceOfFit(lines, options.model);
  const double min_separation_rad = options.min_separation_deg * std::numbers::pi / 180.0;
  std::vector<bool> used(lines.size());
  for (size_t j = 0; j < lines.size(); ++j) used[j] = labels[j] >= 0;
  for (int i = 0; i < options.max_further; ++i) {
    std::vector<size_t> candidates;
    std::set<int32_t> groups;
    for (size_t j = 0; j < lines.size(); ++j) {
      if (used[j]) continue;
      candidates.push_back(j);
      groups.insert(group[j]);
    }
    const auto found = FindDirection(lines, candidates, options, rng);
    if (!found) break;
    const bool known = std::any_of(
        estimate.vanishing_points.begin(), estimate.vanishing_points.end(),
        [&](const VanishingPoint& vp) {
          return AxisAngle_rad(vp.direction_in_cam, found->direction_in_cam) < min_separation_rad;
        });
    if (known) {
      // Out of the way of others, without a label.
      for (const size_t j : found->lines) used[j] = true;
      continue;
    }
    std::set<int32_t> supporting;
    for (const size_t j : found->lines) supporting.insert(group[j]);
    const int count = static_cast<int>(supporting.size());
    const double n = static_cast<double>(groups.size());
    const double log_alarms =
        std::log(std::max(1.0, 0.5 * n * (n - 1))) +
        LogBinomialTail(static_cast<int>(groups.size()), count, further_chance);
    if (count < options.min_further_support || log_alarms > std::log(options.max_false_alarms)) {
      break;
    }
    const auto label = static_cast<int32_t>(estimate.vanishing_points.size());
    for (const size_t j : found->lines) {
      labels[j] = label;
      used[j] = true;
    }
    estimate.vanishing_points.push_back({found->direction_in_cam, found->covariance_rad2, count});
  }
  for (size_t i = 0; i < lines.size(); ++i) {
    estimate.labels[static_cast<size_t>(lines[i].source)] = labels[i];
  }
  return estimate;
}

}  // namespace vpslam
