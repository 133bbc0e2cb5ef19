#include "player/simulator/light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "player/simulator/bvh.h"

namespace vpslam::simulator {
namespace {

constexpr double kCell_m = 0.07;
constexpr int kMaxCells = 90;
constexpr int kLampSteps = 3;     // samples per side of a lamp
constexpr int kAmbientRays = 40;  // over the hemisphere
// Ambient rays of several lengths: a near wall takes more light than a far one.
constexpr double kAmbientReach_m[] = {0.12, 0.35, 0.8, 1.6};

/// Directions around +z, distributed as their cosine, on a golden-angle spiral.
std::vector<Eigen::Vector3d> CosineDirections() {
  std::vector<Eigen::Vector3d> directions;
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < kAmbientRays; ++i) {
    const double r2 = (i + 0.5) / kAmbientRays;
    const double r = std::sqrt(r2);
    directions.emplace_back(r * std::cos(i * golden), r * std::sin(i * golden), std::sqrt(1 - r2));
  }
  return directions;
}

class Baker {
 public:
  explicit Baker(const Scene& scene)
      : scene_(scene), bvh_(scene.quads), directions_(CosineDirections()) {}

  LightMap Bake(const Quad& quad) const {
    LightMap map;
    if (quad.emission > 0) {
      map.values.assign(4, static_cast<float>(quad.emission * quad.tint));
      return map;
    }
    const double length_u = quad.u.norm(), length_v = quad.v.norm();
    map.cells_x = std::clamp(static_cast<int>(std::ceil(length_u / kCell_m)), 1, kMaxCells);
    map.cells_y = std::clamp(static_cast<int>(std::ceil(length_v / kCell_m)), 1, kMaxCells);
    // Corners of the grid move inwards a little: on the rim a point may lie inside a neighbour.
    const double inset_u = std::min(0.2, 0.004 / length_u);
    const double inset_v = std::min(0.2, 0.004 / length_v);
    for (int y = 0; y <= map.cells_y; ++y) {
      for (int x = 0; x <= map.cells_x; ++x) {
        const double a = std::clamp(static_cast<double>(x) / map.cells_x, inset_u, 1 - inset_u);
        const double b = std::clamp(static_cast<double>(y) / map.cells_y, inset_v, 1 - inset_v);
        const Eigen::Vector3d point = quad.origin + a * quad.u + b * quad.v;
        map.values.push_back(static_cast<float>(quad.tint * Irradiance(point, quad.Normal())));
      }
    }
    return map;
  }

 private:
  double Irradiance(const Eigen::Vector3d& on_surface, const Eigen::Vector3d& normal) const {
    const Eigen::Vector3d point = on_surface + 2e-3 * normal;
    return Direct(point, normal) + scene_.ambient * Openness(point, normal);
  }

  double Direct(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
    double sum = 0;
    for (const Lamp& lamp : scene_.lamps) {
      const Eigen::Vector3d lamp_normal = lamp.v.cross(lamp.u);  // its length is the area
      double lamp_sum = 0;
      for (int i = 0; i < kLampSteps * kLampSteps; ++i) {
        const Eigen::Vector3d to = lamp.origin + (i % kLampSteps + 0.5) / kLampSteps * lamp.u +
                                   (i / kLampSteps + 0.5) / kLampSteps * lamp.v - point;
        const double cos_here = normal.dot(to), cos_lamp = -lamp_normal.dot(to);
        if (cos_here <= 0 || cos_lamp <= 0) continue;
        if (bvh_.Occluded(point, to)) continue;
        const double r2 = to.squaredNorm();
        lamp_sum += cos_here * cos_lamp / (r2 * r2);
      }
      sum += lamp.radiance * lamp_sum / (kLampSteps * kLampSteps * std::numbers::pi);
    }
    return sum;
  }

  double Openness(const Eigen::Vector3d& point, const Eigen::Vector3d& normal) const {
    const Eigen::Vector3d x = normal.unitOrthogonal();
    const Eigen::Vector3d y = normal.cross(x);
    int open = 0;
    for (int i = 0; i < kAmbientRays; ++i) {
      const Eigen::Vector3d& d = directions_[i];
      const double reach = kAmbientReach_m[i % std::size(kAmbientReach_m)];
      if (!bvh_.Occluded(point, reach * (d.x() * x + d.y() * y + d.z() * normal))) ++open;
    }
    return static_cast<double>(open) / kAmbientRays;
  }

  const Scene& scene_;
  Bvh bvh_;
  std::vector<Eigen::Vector3d> directions_;
};

}  // namespace

std::vector<LightMap> BakeLight(const Scene& scene) {
  const Baker baker(scene);
  std::vector<LightMap> maps;
  maps.reserve(scene.quads.size());
  for (const Quad& quad : scene.quads) maps.push_back(baker.Bake(quad));
  return maps;
}

}  // namespace vpslam::simulator
