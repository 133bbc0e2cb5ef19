#include "vpdetector/vp_refine.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "core/geometry/so3.h"

namespace vpslam {
namespace {

/// Information of a direction that nothing is known of: a standard deviation of 90 degrees.
constexpr double kNoInformation = 4.0 / (std::numbers::pi * std::numbers::pi);

struct NormalEquations {
  Eigen::Matrix3d h = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double lines = 0;    ///< sum of weights
  double squares = 0;  ///< weighted sum of squared normalised residuals

  /// `trust` in 0 to 1 is the robust weight. It counts for the step and the information that is
  /// left, not for how well the lines fit.
  void Add(const VpLine& line, const Eigen::Vector3d& d, double trust, double variance) {
    const Eigen::Vector3d jacobian = ResidualJacobian(line.normal, d);
    const double residual = line.normal.dot(d);
    const double information = line.weight / variance;
    h += trust * information * jacobian * jacobian.transpose();
    g += trust * information * residual * jacobian;
    lines += line.weight;
    squares += information * residual * residual;
  }
  Eigen::Vector3d Step() const {
    // The little added holds what no line sees, a rotation about the only axis in view.
    return -(h + kNoInformation * Eigen::Matrix3d::Identity()).ldlt().solve(g);
  }
  Eigen::Matrix3d Covariance(const VpModel& model) const {
    const double scale =
        (squares + model.prior_lines) / std::max(1.0, lines + model.prior_lines - 3.0);
    return (h / scale + kNoInformation * Eigen::Matrix3d::Identity()).inverse();
  }
};

/// The axis that a line fits best and by how much.
struct Label {
  int32_t axis = -1;
  double score = 0;
  double variance = 1;
  double gain = 1;

  /// Falls from 1 to 0 as the score does: a line at the gate must not pull, then jump.
  double Trust() const { return score / gain; }
};

Label BestAxis(const VpLine& line, const Eigen::Matrix3d& r, const VpModel& model, double world,
               double max_gain) {
  Label best;
  for (int32_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d d = r.col(k);
    const double distance = line.normal.dot(d);
    if (std::abs(distance) > 0.3) continue;  // 17 degrees: no line is that vague
    const double variance = line.EndPointVariance(d) + world;
    // Most axes fail even with the largest gain there is, and need no logarithm.
    if (0.5 * distance * distance > max_gain * variance) continue;
    const double gain = model.Gain(variance);
    const double score = gain - 0.5 * distance * distance / variance;
    if (score > best.score) best = {k, score, variance, gain};
  }
  return best;
}

}  // namespace

double VpModel::WorldVariance() const {
  const double sigma = world_sigma_deg * std::numbers::pi / 180.0;
  return sigma * sigma;
}

double VpModel::Gain(double variance) const {
  return std::log(2.0 * inlier_ratio / std::sqrt(2.0 * std::numbers::pi * variance));
}

std::optional<std::string> VpModel::Validate() const {
  if (!(world_sigma_deg >= 0.01 && world_sigma_deg <= 10)) {
    return "world_sigma_deg must lie in 0.01 to 10";
  }
  if (!(inlier_ratio > 0 && inlier_ratio < 1)) return "inlier_ratio must lie between 0 and 1";
  if (!(prior_lines > 0)) return "prior_lines must be positive";
  return std::nullopt;
}

double LineScore(const VpLine& line, const Eigen::Vector3d& d, const VpModel& model) {
  const double variance = line.EndPointVariance(d) + model.WorldVariance();
  const double distance = line.normal.dot(d);
  return model.Gain(variance) - 0.5 * distance * distance / variance;
}

ManhattanFit LabelLines(const std::vector<VpLine>& lines, const Eigen::Matrix3d& cam_from_manhattan,
                        const VpModel& model) {
  ManhattanFit fit;
  fit.cam_from_manhattan = cam_from_manhattan;
  fit.labels.reserve(lines.size());
  NormalEquations equations;
  const double world = model.WorldVariance(), max_gain = model.Gain(world);
  for (const VpLine& line : lines) {
    const Label label = BestAxis(line, cam_from_manhattan, model, world, max_gain);
    fit.labels.push_back(label.axis);
    if (label.axis < 0) continue;
    fit.score += line.weight * label.score;
    equations.Add(line, cam_from_manhattan.col(label.axis), label.Trust(), label.variance);
  }
  fit.covariance_rad2 = equations.Covariance(model);
  return fit;
}

ManhattanFit RefineManhattan(const std::vector<VpLine>& lines, const Eigen::Matrix3d& start,
                             const VpModel& model, int max_iterations) {
  Eigen::Quaterniond q(start);
  q.normalize();
  const double world = model.WorldVariance(), max_gain = model.Gain(world);
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Eigen::Matrix3d r = q.toRotationMatrix();
    NormalEquations equations;
    for (const VpLine& line : lines) {
      const Label label = BestAxis(line, r, model, world, max_gain);
      if (label.axis < 0) continue;
      equations.Add(line, r.col(label.axis), label.Trust(), label.variance);
    }
    const Eigen::Vector3d step = equations.Step();
    q = (ExpSo3(step) * q).normalized();
    if (step.squaredNorm() < 1e-10) break;  // 0.0006 degrees
  }
  return LabelLines(lines, q.toRotationMatrix(), model);
}

ManhattanFit FitLabelledLines(const std::vector<VpLine>& lines, const std::vector<int32_t>& labels,
                              const Eigen::Matrix3d& start, const VpModel& model) {
  Eigen::Quaterniond q(start);
  q.normalize();
  ManhattanFit fit;
  fit.labels = labels;
  for (int iteration = 0; iteration < 20; ++iteration) {
    const Eigen::Matrix3d r = q.toRotationMatrix();
    NormalEquations equations;
    for (size_t i = 0; i < lines.size(); ++i) {
      if (labels[i] < 0) continue;
      const Eigen::Vector3d d = r.col(labels[i]);
      equations.Add(lines[i], d, 1.0, lines[i].EndPointVariance(d) + model.WorldVariance());
    }
    fit.covariance_rad2 = equations.Covariance(model);
    const Eigen::Vector3d step = equations.Step();
    q = (ExpSo3(step) * q).normalized();
    if (step.squaredNorm() < 1e-18) break;
  }
  fit.cam_from_manhattan = q.toRotationMatrix();
  return fit;
}

}  // namespace vpslam
