// The pose of a camera from three points.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/se3.h"

namespace vpslam {

/// All cam_from_world (up to 4) that put three points of
/// the world on three rays, given as normalised coordinates, in front of the camera. Empty if the
/// points lie on a line.
///
/// Grunert's equations for the distances of the points, reduced to a quartic ([Har94] "Review and
/// analysis of solutions of the three point perspective pose estimation problem"), whose roots are
/// polished on the equations themselves by Newton's method, as [Per18] ("Lambda Twist") does.
std::vector<SE3> SolveP3p(const std::array<Eigen::Vector3d, 3>& points_in_world,
                          const std::array<Eigen::Vector2d, 3>& rays);

}  // namespace vpslam
