// Two views of a made-up scene with known motion, for the tests of estimators.
#pragma once

#include <cmath>
#include <random>
#include <vector>

#include "core/geometry/camera.h"
#include "core/geometry/se3.h"
#include "core/geometry/two_view.h"

namespace vpslam {

inline double Radians(double degrees) { return degrees * M_PI / 180; }

inline Camera SceneCamera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 520;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

enum class SceneShape {
  kGeneral,        ///< depths from 2 to 8
  kSlantedPlane,   ///< normal 20 to 50 degrees off the optical axis, 4 away in the middle
  kFrontoParallel  ///< a plane at depth 4, within a degree
};

struct SceneOptions {
  SceneShape shape = SceneShape::kGeneral;
  int num_matches = 200;
  double noise_px = 1;       ///< per coordinate, in both images
  double outlier_share = 0;  ///< anywhere within 100 px of the right position
  /// Angle under which a point at depth 4 sees the baseline; 0 for pure rotation.
  double parallax_rad = Radians(3);
  bool forward = false;  ///< along the optical axis instead of in a random direction
  double rotation_sigma_rad = Radians(3);
};

struct Scene {
  SE3 second_from_first;  ///< with a translation of true length
  std::vector<TwoViewMatch> matches;
  std::vector<Eigen::Vector3d> points;  ///< in the first camera; of outliers as well
  std::vector<bool> is_outlier;
};

class SceneMaker {
 public:
  explicit SceneMaker(uint64_t seed) : rng_(seed) {}

  Scene Make(const SceneOptions& options) {
    constexpr double kDepth = 4;
    const Camera camera = SceneCamera();
    const Camera::Bounds bounds = camera.UndistortedBounds();
    Scene scene;
    Eigen::Vector3d direction = NormalVector(1).normalized();
    if (options.forward) direction = Eigen::Vector3d(0.05, -0.05, -1).normalized();
    // The centre of the second camera; sideways, so that the parallax is what is asked for.
    if (!options.forward)
      direction = Eigen::Vector3d(direction.x(), direction.y(), 0.5 * direction.z()).normalized();
    const double baseline = 2 * kDepth * std::tan(0.5 * options.parallax_rad);
    scene.second_from_first = SE3(ExpSo3(NormalVector(options.rotation_sigma_rad)),
                                  Eigen::Vector3d(baseline * direction));
    double tilt_rad = 0;
    if (options.shape == SceneShape::kSlantedPlane) tilt_rad = Radians(Uniform(20, 50));
    if (options.shape == SceneShape::kFrontoParallel) tilt_rad = Radians(Uniform(0, 1));
    const double azimuth_rad = Uniform(0, 2 * M_PI);
    const Eigen::Vector3d normal(std::sin(tilt_rad) * std::cos(azimuth_rad),
                                 std::sin(tilt_rad) * std::sin(azimuth_rad), std::cos(tilt_rad));
    int num_tries = 0;
    while (static_cast<int>(scene.matches.size()) < options.num_matches) {
      // Where the views hardly overlap, another motion has to do.
      if (++num_tries > 200 * options.num_matches) return Make(options);
      const Eigen::Vector2d first(Uniform(0, camera.width), Uniform(0, camera.height));
      const Eigen::Vector3d ray = camera.Unproject(first);
      const double depth = options.shape == SceneShape::kGeneral
                               ? Uniform(2, 8)
                               : kDepth * normal.z() / normal.dot(ray);
      if (!(depth > 0.5 && depth < 50)) continue;
      const Eigen::Vector3d point = depth * ray;
      const Eigen::Vector3d in_second = scene.second_from_first * point;
      if (in_second.z() < 0.3) continue;
      Eigen::Vector2d second = camera.Project(in_second);
      if (!bounds.Contains(second)) continue;
      const bool outlier =
          scene.matches.size() < static_cast<size_t>(options.outlier_share * options.num_matches);
      if (outlier) second += Eigen::Vector2d(Uniform(-100, 100), Uniform(-100, 100));
      TwoViewMatch match;
      match.first_px = first + NormalVector(options.noise_px).head<2>();
      match.second_px = second + NormalVector(options.noise_px).head<2>();
      scene.matches.push_back(match);
      scene.points.push_back(point);
      scene.is_outlier.push_back(outlier);
    }
    return scene;
  }

  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng_);
  }
  Eigen::Vector3d NormalVector(double sigma) {
    std::normal_distribution<double> normal(0, 1);
    const double x = normal(rng_), y = normal(rng_), z = normal(rng_);
    return sigma * Eigen::Vector3d(x, y, z);
  }

 private:
  std::mt19937_64 rng_;
};

inline double RotationError_rad(const SE3& a, const SE3& b) {
  return AngleBetween_rad(a.rotation, b.rotation);
}

inline double DirectionError_rad(const SE3& a, const SE3& b) {
  return std::atan2(a.translation.cross(b.translation).norm(), a.translation.dot(b.translation));
}

}  // namespace vpslam
