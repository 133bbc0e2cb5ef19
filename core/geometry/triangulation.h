// Points from rays.
//
// All in normalised image coordinates, (x/z, y/z) of a point in camera coordinates; standard
// deviations have the same unit, sigma_px / f.
#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "core/geometry/camera.h"
#include "core/geometry/se3.h"

namespace vpslam {

/// One point seen in two images: normalised coordinates, and the variance of each coordinate.
struct RayMatch {
  Eigen::Vector2d first, second;
  Eigen::Vector2d first_variance, second_variance;
};

/// A position in px as normalised coordinates, with their variances.
RayMatch MakeRayMatch(const Camera& camera, const Eigen::Vector2d& first_px,
                      const Eigen::Vector2d& second_px, double first_sigma_px,
                      double second_sigma_px);

/// The point in coordinates of the first camera which explains both observations best, or nullopt
/// if it lies behind a camera or so far away that no parallax is left. If parallax_rad is given,
/// the angle between the two rays is written there whenever the result has a value.
///
/// Moves both observations onto the epipolar geometry by the least squares step of the
/// linearised constraint, twice, and intersects the rays, which then meet; within rounding of the
/// optimum for errors of a few px ([Lin10] "Triangulation made easy", [HZ04] sec. 12.5). The
/// motion is taken for exact.
std::optional<Eigen::Vector3d> TriangulateTwoView(const SE3& second_from_first,
                                                  const RayMatch& match,
                                                  double* parallax_rad = nullptr);

/// A point's observation in one of several images.
struct RayObservation {
  SE3 cam_from_world;
  Eigen::Vector2d position;  ///< normalised
  double sigma = 1;          ///< normalised: sigma_px / f
};

/// The point in the world by the linear method, homogeneous so that far points do no harm ([HZ04]
/// sec. 12.2); minimises no geometric error and checks no depth. nullopt for fewer than two
/// observations, input that is not finite, rays that all coincide, or a point at infinity.
std::optional<Eigen::Vector3d> TriangulateLinear(std::span<const RayObservation> observations);

struct TriangulationOptions {
  /// Largest angle between any two of the rays must reach this.
  double min_parallax_rad = 1e-3;
  int max_iterations = 10;

  std::optional<std::string> Validate() const;
};

/// The point in the world with the least sum of squared reprojection errors, each divided by its
/// sigma: linear, then Gauss-Newton. nullopt also if the point lies behind one of the cameras, or
/// if there is too little parallax. There is no outlier rejection.
std::optional<Eigen::Vector3d> Triangulate(std::span<const RayObservation> observations,
                                           const TriangulationOptions& options = {});

/// Angle at `point` between the rays to two camera centres, in [0, pi].
double Parallax_rad(const Eigen::Vector3d& point, const Eigen::Vector3d& center_a,
                    const Eigen::Vector3d& center_b);

/// Squared reprojection error over sigma^2: chi-square with two degrees of freedom. Infinity if the
/// point is not in front of the camera.
double ReprojectionChi2(const RayObservation& observation, const Eigen::Vector3d& point_in_world);

}  // namespace vpslam
