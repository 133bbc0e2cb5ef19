// Three orthogonal vanishing directions at once: least squares on SO(3) over labelled lines.
//
// Columns of R = cam_from_manhattan are the directions d_k. With s_i the normal of line i and k its
// label, r_i = (s_i . d_k) / sigma_i, which is smooth and free of the signs of both. R moves to
// Exp(w) R, so dr_i/dw = (d_k x s_i)^T / sigma_i.
//
// Likelihood: a line either belongs to the axis, with r ~ N(0, 1), or to none of them, with s . d
// uniform in [-1, 1] as for a random plane. Its score is the logarithm of the ratio of the two, cut
// at zero: score = max(0, ln(2 inlier_ratio / (sqrt(2 pi) sigma)) - r^2 / 2). So the gate follows
// from the line's own sigma: about 3 sigma, and a line that is too vague to tell anything says
// nothing.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "vpdetector/vp_lines.h"

namespace vpslam {

struct VpModel {
  /// Standard deviation of the angle between an edge of the world and its axis.
  double world_sigma_deg = 0.4;
  /// Share of the lines that are expected to belong to one given axis.
  double inlier_ratio = 0.25;
  /// Covariances are scaled by how well the image's own lines fit,
  /// s^2 = (sum of r^2 + n0) / (n + n0 - 3): some places are built more exactly than others. n0 is
  /// how many lines' worth of belief in the sigmas above there is to begin with.
  double prior_lines = 1.0;

  double WorldVariance() const;
  /// ln(2 inlier_ratio / (sqrt(2 pi) sigma)); what a line that fits exactly adds to the score.
  double Gain(double variance) const;

  template <class V>
  void Visit(V& v) {
    v("world_sigma_deg", world_sigma_deg);
    v("inlier_ratio", inlier_ratio);
    v("prior_lines", prior_lines);
  }
  std::optional<std::string> Validate() const;
};

/// Derivative of normal . d by the left perturbation w of R, where d is a column of R.
inline Eigen::Vector3d ResidualJacobian(const Eigen::Vector3d& normal, const Eigen::Vector3d& d) {
  return d.cross(normal);
}

/// Score of a line for direction d; <= 0 means that it does not belong to it.
double LineScore(const VpLine& line, const Eigen::Vector3d& d, const VpModel& model);

struct ManhattanFit {
  Eigen::Matrix3d cam_from_manhattan = Eigen::Matrix3d::Identity();
  /// Of the left perturbation, s^2 H^-1; what no line holds has a standard deviation of 90 degrees.
  Eigen::Matrix3d covariance_rad2 = Eigen::Matrix3d::Zero();
  std::vector<int32_t> labels;  ///< per line 0 to 2, or -1
  double score = 0;             ///< sum over labelled lines
};

/// Labels for a fixed rotation, their score, and the covariance that they would give.
ManhattanFit LabelLines(const std::vector<VpLine>& lines, const Eigen::Matrix3d& cam_from_manhattan,
                        const VpModel& model);

/// Iteratively reweighted Gauss-Newton from `start`, labelling anew in every round.
ManhattanFit RefineManhattan(const std::vector<VpLine>& lines, const Eigen::Matrix3d& start,
                             const VpModel& model, int max_iterations = 10);

/// The same for given labels (0 to 2, or -1) that are trusted: no line is weighed down. `score` is
/// left at 0.
ManhattanFit FitLabelledLines(const std::vector<VpLine>& lines, const std::vector<int32_t>& labels,
                              const Eigen::Matrix3d& start, const VpModel& model);

}  // namespace vpslam
