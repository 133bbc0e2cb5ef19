// The Manhattan axes of the camera followed over time: which axis is which, and its sign.
//
// A detector names axes anew in every image: cam_from_manhattan is one of the 24 rotations R Q with
// the same three axes, Q a signed permutation with determinant 1. Here one of them is chosen, the
// nearest to what was predicted, so that a name stays with its axis; and what a detector says is
// let in only where its support, its spread and its distance from the prediction allow it.
//
// State: R = cam_from_manhattan and its covariance P (left perturbation, as everywhere).
//   predict  R <- dR R, P <- dR P dR^T + N, with dR = cam_now_from_cam_before and its covariance N
//   update   r = Log(R_vp R^T), accepted if r^T (S + P)^-1 r < gate; then, as a Kalman filter does,
//            K = P (P + S)^-1, R <- Exp(K r) R, P <- (I - K) P
// Errors of a scene's VPs do not average out from image to image: P never gets smaller than
// `correlation` times S.
//
// Knows neither LCM nor time: what it does depends on its inputs and their order alone.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/features/line_set.h"
#include "core/geometry/axis_naming.h"

namespace vpslam {

struct AxisFollowerOptions {
  /// Distinct lines that at least two axes need.
  int min_support = 5;
  /// Standard deviation of the measured rotation about its worst direction.
  double max_sigma_deg = 1.0;
  /// Floor of the measured standard deviations: detectors are more certain than they are right.
  double min_sigma_deg = 0.1;
  double correlation = 0.5;
  /// 99.9 % of chi-square with three degrees of freedom.
  double gate = 16.27;
  /// Beyond that an innovation is refused, however uncertain the prediction is: at 45 degrees the
  /// names of the axes are anyone's guess.
  double max_innovation_deg = 25.0;
  /// Born after so many acceptable measurements in a row that agree, each with the prediction from
  /// those before.
  int frames_to_birth = 3;
  /// Lost when the prediction is less certain than that: names change at 45 degrees, and three
  /// sigmas should stay within half of it ...
  double max_predicted_sigma_deg = 7.5;
  /// ... or after so many measurements in a row that are good in themselves, but do not fit.
  int misfits_to_loss = 10;

  template <class V>
  void Visit(V& v) {
    v("min_support", min_support);
    v("max_sigma_deg", max_sigma_deg);
    v("min_sigma_deg", min_sigma_deg);
    v("correlation", correlation);
    v("gate", gate);
    v("max_innovation_deg", max_innovation_deg);
    v("frames_to_birth", frames_to_birth);
    v("max_predicted_sigma_deg", max_predicted_sigma_deg);
    v("misfits_to_loss", misfits_to_loss);
  }
  std::optional<std::string> Validate() const;
};

class AxisFollower {
 public:
  enum class Outcome {
    kNothing,    ///< no Manhattan axes in this image
    kPoor,       ///< too little support, or too much spread
    kMisfit,     ///< too far from the prediction
    kBeginning,  ///< taken in, but the axes are not born yet
    kFollowed,   ///< taken in
  };

  struct Update {
    Outcome outcome = Outcome::kNothing;
    /// The image's own measurement under the followed names; meaningful from kMisfit on.
    Eigen::Quaterniond cam_from_manhattan = Eigen::Quaterniond::Identity();
    Eigen::Matrix3d covariance_rad2 = Eigen::Matrix3d::Zero();  ///< with the floor, of the same
    /// Renames labels 0 to 2 of the LineSet.
    AxisNaming naming;
  };

  /// Throws std::invalid_argument if the options do not validate.
  explicit AxisFollower(const AxisFollowerOptions& options);

  /// The camera has turned since the last image. `covariance_rad2` is that of the left perturbation
  /// of `cam_now_from_cam_before`.
  void Predict(const Eigen::Quaterniond& cam_now_from_cam_before,
               const Eigen::Matrix3d& covariance_rad2);
  Update Take(const LineSet& lines);
  void Reset();

  /// Whether the axes have been born and not been lost.
  bool IsFollowing() const { return is_born_; }
  /// Counts births: names of different generations have nothing to do with each other.
  int generation() const { return generation_; }
  /// Meaningful while following.
  const Eigen::Quaterniond& cam_from_manhattan() const { return cam_from_manhattan_; }
  const Eigen::Matrix3d& covariance_rad2() const { return covariance_rad2_; }

 private:
  void Begin(const Update& update);
  bool Fits(const Update& update) const;
  void Fuse(const Update& update);

  const AxisFollowerOptions options_;
  bool has_state_ = false;
  bool is_born_ = false;
  int generation_ = 0;
  int taken_ = 0;    ///< since Begin
  int misfits_ = 0;  ///< in a row
  Eigen::Quaterniond cam_from_manhattan_ = Eigen::Quaterniond::Identity();
  Eigen::Matrix3d covariance_rad2_ = Eigen::Matrix3d::Zero();
};

}  // namespace vpslam
