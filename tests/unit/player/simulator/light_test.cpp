#include "player/simulator/light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "player/simulator/bvh.h"
#include "player/simulator/random.h"

namespace vpslam::simulator {
namespace {

Eigen::Vector3d RandomVector(Random& random, double size) {
  return {random.Uniform(-size, size), random.Uniform(-size, size), random.Uniform(-size, size)};
}

/// By solving for the plane's own coordinates, another way than the hierarchy does.
bool CutsQuad(const Quad& q, const Eigen::Vector3d& from, const Eigen::Vector3d& direction) {
  Eigen::Matrix3d m;
  m << q.u, q.v, -direction;
  const Eigen::Vector3d abt = m.colPivHouseholderQr().solve(from - q.origin);
  return abt.minCoeff() > 0 && abt.maxCoeff() < 1;
}

TEST(Bvh, AgreesWithTestingEveryQuad) {
  Random random(11);
  std::vector<Quad> quads(150);
  for (Quad& q : quads) {
    q.origin = RandomVector(random, 3);
    q.u = RandomVector(random, 0.6);
    q.v = RandomVector(random, 0.6);
    q.casts_shadow = random.Chance(0.9);
  }
  const Bvh bvh(quads);
  int occluded = 0;
  for (int i = 0; i < 3000; ++i) {
    const Eigen::Vector3d from = RandomVector(random, 3), direction = RandomVector(random, 3);
    const bool expected = std::any_of(quads.begin(), quads.end(), [&](const Quad& q) {
      return q.casts_shadow && CutsQuad(q, from, direction);
    });
    occluded += expected;
    EXPECT_EQ(bvh.Occluded(from, direction), expected) << i;
  }
  EXPECT_GT(occluded, 300);
  EXPECT_LT(occluded, 2700);
}

/// A floor 2 x 2 m around the origin, lit by a small lamp 2 m above its middle.
Scene FloorAndLamp(double ambient) {
  Scene scene;
  scene.ambient = ambient;
  Quad floor;
  floor.origin = {-1, 1, 0};
  floor.u = {2, 0, 0};
  floor.v = {0, -2, 0};
  scene.quads.push_back(floor);
  scene.lamps.push_back({{-0.05, -0.05, 2}, {0.1, 0, 0}, {0, 0.1, 0}, 100});
  return scene;
}

float ValueAt(const LightMap& map, double a, double b) {
  const int x = static_cast<int>(std::lround(a * map.cells_x));
  const int y = static_cast<int>(std::lround(b * map.cells_y));
  return map.values[y * (map.cells_x + 1) + x];
}

TEST(Light, FallsOffAsTheLambertianLawSays) {
  const LightMap map = BakeLight(FloorAndLamp(0)).front();
  const double area = 0.01, radiance = 100;
  const double below = radiance * area / (std::numbers::pi * 4);
  const auto at = [&](double distance_m) {
    const double cosine = 2 / std::hypot(2, distance_m);
    return below * std::pow(cosine, 4);
  };
  const double x = std::round(0.5 * map.cells_x) / map.cells_x * 2 - 1;
  EXPECT_NEAR(ValueAt(map, 0.5, 0.5), at(std::hypot(x, x)), 0.01 * below);
  EXPECT_NEAR(ValueAt(map, 0, 0), at(std::sqrt(2)), 0.02 * below);
}

TEST(Light, AnObstacleCastsAShadow) {
  Scene scene = FloorAndLamp(0);
  Quad board;
  board.origin = {-0.3, 0.3, 0.2};
  board.u = {0.6, 0, 0};
  board.v = {0, -0.6, 0};
  scene.quads.push_back(board);
  const LightMap map = BakeLight(scene).front();
  EXPECT_LT(ValueAt(map, 0.5, 0.5), 1e-6);
  EXPECT_GT(ValueAt(map, 0.05, 0.05), 0.03);
}

TEST(Light, ACornerReceivesLessAmbientLight) {
  Scene scene = FloorAndLamp(1);
  scene.lamps.clear();
  Quad wall;
  wall.origin = {-1, -1, 2};
  wall.u = {0, 2, 0};
  wall.v = {0, 0, -2};
  scene.quads.push_back(wall);
  const LightMap map = BakeLight(scene).front();
  EXPECT_LT(ValueAt(map, 0, 0.5), 0.65);
  EXPECT_NEAR(ValueAt(map, 1, 0.5), 1, 1e-6);
}

}  // namespace
}  // namespace vpslam::simulator
