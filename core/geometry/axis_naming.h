// Which Manhattan axis is which: a detector names the three directions of an image as it likes, and
// any of them may point either way.
#pragma once

#include <array>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace vpslam {

/// One of the 24 ways to name three axes: column k of R Q is `sign[k]` times column `from[k]` of R.
struct AxisNaming {
  std::array<int, 3> from{0, 1, 2};
  std::array<int, 3> sign{1, 1, 1};

  Eigen::Matrix3d Matrix() const;  ///< Q
  /// New name of what was axis `k`.
  int NameOf(int k) const;
};

/// The naming that brings `cam_from_manhattan` nearest to `predicted`.
AxisNaming NearestNaming(const Eigen::Matrix3d& cam_from_manhattan,
                         const Eigen::Matrix3d& predicted);

/// `cam_from_manhattan` under that naming.
Eigen::Quaterniond NamedNearest(const Eigen::Quaterniond& cam_from_manhattan,
                                const Eigen::Quaterniond& predicted);

}  // namespace vpslam
