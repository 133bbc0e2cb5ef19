// The absolute rotation of a frame from vanishing points, as the paper has it (sec. III-B). See
// docs/method.md for what is wrong with it, and core/estimation/rotation_cost.h for what is done
// instead.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/features/line_set.h"
#include "core/geometry/camera.h"

namespace vpslam {

/// Eq. 2: the direction d with S^T d = 0, by SVD; the columns of S are the normals of the planes
/// through the camera and each line, normalised, which the paper does not say. Unit, in the
/// camera's axes, of either sign. nullopt for fewer than two lines or parallel normals.
std::optional<Eigen::Vector3d> DominantDirection(std::span<const Eigen::Vector3d> normals);

/// Eq. 2 for each Manhattan axis of the image, from the lines that carry its label; none for axes
/// with fewer than `min_lines`.
std::array<std::optional<Eigen::Vector3d>, 3> DominantDirections(const LineSet& lines,
                                                                 const Camera& camera,
                                                                 int min_lines);

/// A direction seen by the camera (delta in eq. 4), and the same in the world (d).
struct DirectionPair {
  Eigen::Vector3d in_cam;
  Eigen::Vector3d in_world;
};

/// Eq. 5: minimises the sum of squared angles arccos(delta_k . R d_k) by Levenberg-Marquardt over
/// left perturbations of R, from `cam_from_world` on. A sum of angles as the paper writes it is not
/// what its LM can minimise; and delta has the sign that makes the angle less than 90 degrees.
Eigen::Quaterniond OptimizeAbsoluteRotation(std::span<const DirectionPair> pairs,
                                            const Eigen::Quaterniond& cam_from_world);

}  // namespace vpslam
