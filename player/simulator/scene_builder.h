// Puts a scene together from boxes, sheets and prisms. Furniture is described in a frame of its
// own: x to the right as one stands in front of it, y away from the viewer, z up; a wall is the
// plane y = 0 and things hang or stand at y < 0.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "player/simulator/random.h"
#include "player/simulator/scene.h"

namespace vpslam::simulator {

/// How a face looks.
struct Surface {
  int texture = 0;
  /// Of a texture that wraps; a random piece of it is cut out. 0: the whole texture once.
  double texels_per_m = 0;
  double tint = 1;
  double gloss = 0;

  Surface Tinted(double factor) const {
    Surface s = *this;
    s.tint *= factor;
    return s;
  }
  Surface Glossy(double amount) const {
    Surface s = *this;
    s.gloss = amount;
    return s;
  }
};

/// Upright pose: turned about z, then moved.
struct Placement {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  double yaw_rad = 0;

  Eigen::Vector3d Point(const Eigen::Vector3d& x) const { return origin + Direction(x); }
  Eigen::Vector3d Direction(const Eigen::Vector3d& x) const;
  /// This placement, then another one inside it.
  Placement Within(const Eigen::Vector3d& at, double turn_rad = 0) const {
    return {Point(at), yaw_rad + turn_rad};
  }
};

enum class Face { kRight, kLeft, kBack, kFront, kTop, kBottom };  // +x -x +y -y +z -z

class SceneBuilder {
 public:
  explicit SceneBuilder(uint64_t seed) : random_(seed) {}

  /// A texture that wraps, cut to measure wherever it is used.
  Surface Material(const cv::Mat1f& reflectance, double texels_per_m);
  /// A texture shown whole on each face.
  Surface Print(const cv::Mat1f& reflectance);

  /// The face origin + a u + b v (see Quad); returns it for further settings.
  Quad& AddQuad(const Placement& where, const Eigen::Vector3d& origin, const Eigen::Vector3d& u,
                const Eigen::Vector3d& v, const Surface& surface);
  /// A box between two corners, and its twelve edges as true lines. `other` names faces that look
  /// different.
  void AddBox(const Placement& where, const Eigen::Vector3d& low, const Eigen::Vector3d& high,
              const Surface& surface, const std::vector<std::pair<Face, Surface>>& other = {});
  /// A thin sheet or booklet on the point `centre`: a box 2 mm high whose top shows `surface`,
  /// turned about z; `rim` is what its sides show.
  void AddLyingSheet(const Placement& where, const Eigen::Vector3d& centre, double width,
                     double height, double turn_rad, const Surface& surface, const Surface& rim);
  /// An upright prism, open at the top: mugs, pots, bins. It has no true lines, being round.
  void AddPrism(const Placement& where, const Eigen::Vector3d& foot, double radius_low,
                double radius_high, double height, int sides, const Surface& surface);
  void AddLine(const Placement& where, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
               LineKind kind);
  /// A face that shines, and the lamp that it is.
  void AddLamp(const Placement& where, const Eigen::Vector3d& origin, const Eigen::Vector3d& u,
               const Eigen::Vector3d& v, const Surface& surface, double emission, double radiance);

  Random& random() { return random_; }
  Scene& scene() { return scene_; }

 private:
  Random random_;
  Scene scene_;
};

}  // namespace vpslam::simulator
