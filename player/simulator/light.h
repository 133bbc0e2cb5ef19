// Baked light: for every quad a coarse grid of irradiance, computed once per scene, so that a frame
// pays nothing for soft shadows, falloff and the darkening of corners.
#pragma once

#include <vector>

#include "player/simulator/scene.h"

namespace vpslam::simulator {

/// Light that a quad reflects per unit of texture reflectance: its tint is included.
struct LightMap {
  int cells_x = 1;
  int cells_y = 1;
  std::vector<float> values;  ///< (cells_x + 1) x (cells_y + 1), at the corners of the cells
};

/// One map per quad. Direct light of the lamps with soft shadows, falling off with cos cos / r^2,
/// plus the ambient light that the neighbourhood lets through.
std::vector<LightMap> BakeLight(const Scene& scene);

}  // namespace vpslam::simulator
