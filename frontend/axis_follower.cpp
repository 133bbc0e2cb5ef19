#include "frontend/axis_follower.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "core/features/manhattan_quality.h"
#include "core/geometry/so3.h"

namespace vpslam {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

double Square(double x) { return x * x; }

/// No principal variance below `least`.
Eigen::Matrix3d WithFloor(const Eigen::Matrix3d& covariance, double least) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Matrix3d& v = solver.eigenvectors();
  return v * solver.eigenvalues().cwiseMax(least).asDiagonal() * v.transpose();
}

}  // namespace

std::optional<std::string> AxisFollowerOptions::Validate() const {
  if (min_support < 1) return "min_support must be >= 1";
  if (!(min_sigma_deg > 0) || !(max_sigma_deg > min_sigma_deg)) {
    return "0 < min_sigma_deg < max_sigma_deg must hold";
  }
  if (!(correlation >= 0) || correlation > 1) return "correlation must be from 0 to 1";
  if (!(gate > 0)) return "gate must be > 0";
  if (!(max_innovation_deg > 0) || max_innovation_deg >= 45) {
    return "max_innovation_deg must be > 0 and < 45";
  }
  if (frames_to_birth < 1 || misfits_to_loss < 1) {
    return "frames_to_birth and misfits_to_loss must be >= 1";
  }
  if (!(max_predicted_sigma_deg > 0)) return "max_predicted_sigma_deg must be > 0";
  return std::nullopt;
}

AxisFollower::AxisFollower(const AxisFollowerOptions& options) : options_(options) {
  if (const auto why = options.Validate()) throw std::invalid_argument(*why);
}

void AxisFollower::Reset() {
  has_state_ = is_born_ = false;
  taken_ = misfits_ = 0;
}

void AxisFollower::Predict(const Eigen::Quaterniond& cam_now_from_cam_before,
                           const Eigen::Matrix3d& covariance_rad2) {
  if (!has_state_) return;
  const Eigen::Matrix3d turn = cam_now_from_cam_before.toRotationMatrix();
  cam_from_manhattan_ = (cam_now_from_cam_before * cam_from_manhattan_).normalized();
  covariance_rad2_ = turn * covariance_rad2_ * turn.transpose() + covariance_rad2;
  if (WorstVariance(covariance_rad2_) > Square(options_.max_predicted_sigma_deg * kRadPerDeg)) {
    Reset();
  }
}

AxisFollower::Update AxisFollower::Take(const LineSet& lines) {
  Update update;
  if (lines.manhattan == ManhattanState::kNone || lines.vanishing_points.size() < 2) return update;
  update.outcome = Outcome::kPoor;
  if (!IsSoundManhattan(lines, options_.min_support, options_.max_sigma_deg * kRadPerDeg)) {
    return update;
  }
  const Eigen::Matrix3d measured = lines.cam_from_manhattan.toRotationMatrix();
  if (has_state_) update.naming = NearestNaming(measured, cam_from_manhattan_.toRotationMatrix());
  update.cam_from_manhattan =
      Eigen::Quaterniond(Eigen::Matrix3d(measured * update.naming.Matrix())).normalized();
  update.covariance_rad2 =
      WithFloor(lines.covariance_rad2, Square(options_.min_sigma_deg * kRadPerDeg));
  if (!has_state_) {
    Begin(update);
  } else if (Fits(update)) {
    Fuse(update);
  } else {
    update.outcome = Outcome::kMisfit;
    // What is not born yet is not worth a defence.
    if (++misfits_ < options_.misfits_to_loss && is_born_) return update;
    Reset();
    return update;
  }
  misfits_ = 0;
  if (++taken_ >= options_.frames_to_birth && !is_born_) {
    is_born_ = true;
    ++generation_;
  }
  update.outcome = is_born_ ? Outcome::kFollowed : Outcome::kBeginning;
  return update;
}

void AxisFollower::Begin(const Update& update) {
  has_state_ = true;
  taken_ = misfits_ = 0;
  cam_from_manhattan_ = update.cam_from_manhattan;
  covariance_rad2_ = update.covariance_rad2;
}

bool AxisFollower::Fits(const Update& update) const {
  const Eigen::Vector3d r = LogSo3(update.cam_from_manhattan * cam_from_manhattan_.conjugate());
  if (r.norm() > options_.max_innovation_deg * kRadPerDeg) return false;
  const Eigen::Matrix3d total = update.covariance_rad2 + covariance_rad2_;
  return r.dot(total.ldlt().solve(r)) < options_.gate;
}

void AxisFollower::Fuse(const Update& update) {
  const Eigen::Vector3d r = LogSo3(update.cam_from_manhattan * cam_from_manhattan_.conjugate());
  const Eigen::Matrix3d total = update.covariance_rad2 + covariance_rad2_;
  const Eigen::Matrix3d gain = total.ldlt().solve(covariance_rad2_).transpose();
  cam_from_manhattan_ = (ExpSo3(gain * r) * cam_from_manhattan_).normalized();
  Eigen::Matrix3d fused = (Eigen::Matrix3d::Identity() - gain) * covariance_rad2_;
  fused = 0.5 * (fused + fused.transpose().eval());
  // P >= correlation S: what P falls short of it, in the directions where it does, is put back.
  const Eigen::Matrix3d floor = options_.correlation * update.covariance_rad2;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> missing(floor - fused);
  const Eigen::Matrix3d& v = missing.eigenvectors();
  covariance_rad2_ = fused + v * missing.eigenvalues().cwiseMax(0.0).asDiagonal() * v.transpose();
}

}  // namespace vpslam
