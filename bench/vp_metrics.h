// How far found vanishing points lie from true ones, and the figures that sum it up over images.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace vpslam {

/// Angles in degrees between three found and three true directions (columns, unit), sign-free,
/// under the pairing with the least sum; in the order of the found ones.
Eigen::Vector3d DirectionErrors_deg(const Eigen::Matrix3d& found, const Eigen::Matrix3d& truth);

/// Smallest rotation, in degrees, that takes the found axes to the true ones, over all 24 ways to
/// name them. Truth need be orthonormal only up to noise and signs.
double RotationError_deg(const Eigen::Matrix3d& found, const Eigen::Matrix3d& truth);

double Median(std::vector<double> values);

class VpErrors {
 public:
  void Add(const Eigen::Matrix3d& found, const Eigen::Matrix3d& truth);

  /// Area in percent under the curve "share of vanishing points with an error below x" for x from 0
  /// to `limit_deg`: the mean of max(0, 1 - error / limit).
  double AA(double limit_deg) const;
  /// Mean over all vanishing points of min(error, 10 degrees).
  double MeanCapped_deg() const;
  double MedianRotation_deg() const { return Median(rotations_deg_); }
  /// Share in percent of images with a rotation error above 5 degrees.
  double ShareOver5_percent() const;
  size_t images() const { return rotations_deg_.size(); }

 private:
  std::vector<double> directions_deg_;
  std::vector<double> rotations_deg_;
};

}  // namespace vpslam
