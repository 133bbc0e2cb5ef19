// What the simulator's camera looks at: textured parallelograms, lamps, and the straight edges that
// are the truth for a line map. World frame: metres, z up, axes along the Manhattan directions.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "player/simulator/texture.h"

namespace vpslam::simulator {

/// The points origin + a u + b v, a and b in [0, 1]. Seen from its front, u points to the right
/// and v down, as in an image; so the normal towards the viewer is v x u.
struct Quad {
  Eigen::Vector3d origin, u, v;
  int texture = 0;
  /// Level-0 texel at (a, b) is offset + (a, b) * scale.
  Eigen::Vector2d texel_offset = {0, 0};
  Eigen::Vector2d texel_scale = {1, 1};
  double tint = 1;           ///< factor on the texture's reflectance
  double emission = 0;       ///< > 0: shines by itself with this radiance, ignoring lamps
  double gloss = 0;          ///< 0 to 1: how much of the lamps it mirrors, blurred
  bool two_sided = false;    ///< visible from behind as well
  bool casts_shadow = true;  ///< off for a lamp's own face

  Eigen::Vector3d Normal() const { return v.cross(u).normalized(); }
};

/// A parallelogram that gives light to the side of v x u.
struct Lamp {
  Eigen::Vector3d origin, u, v;
  double radiance = 1;
};

/// What makes a segment visible.
enum class LineKind : uint8_t {
  kEdge,  ///< an edge of an object: a jump of depth or normal, or the border of a sheet
  kMark,  ///< drawn on a surface: a joint, a frame printed on it
};

struct Line3d {
  Eigen::Vector3d a, b;  ///< m, world
  LineKind kind = LineKind::kEdge;
};

struct Scene {
  std::vector<Texture> textures;
  std::vector<Quad> quads;
  std::vector<Lamp> lamps;
  std::vector<Line3d> lines;
  /// Light that comes from everywhere, in the unit in which reflectance 1 gives radiance 1.
  double ambient = 0.4;
};

}  // namespace vpslam::simulator
