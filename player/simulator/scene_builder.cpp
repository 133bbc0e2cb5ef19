#include "player/simulator/scene_builder.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vpslam::simulator {
namespace {

constexpr double kShortestLine_m = 0.05;  // shorter edges are no use as landmarks

}  // namespace

Eigen::Vector3d Placement::Direction(const Eigen::Vector3d& x) const {
  const double c = std::cos(yaw_rad), s = std::sin(yaw_rad);
  return {c * x.x() - s * x.y(), s * x.x() + c * x.y(), x.z()};
}

Surface SceneBuilder::Material(const cv::Mat1f& reflectance, double texels_per_m) {
  scene_.textures.push_back(MakeTexture(reflectance, true));
  Surface surface;
  surface.texture = static_cast<int>(scene_.textures.size()) - 1;
  surface.texels_per_m = texels_per_m;
  return surface;
}

Surface SceneBuilder::Print(const cv::Mat1f& reflectance) {
  scene_.textures.push_back(MakeTexture(reflectance, false));
  Surface surface;
  surface.texture = static_cast<int>(scene_.textures.size()) - 1;
  return surface;
}

Quad& SceneBuilder::AddQuad(const Placement& where, const Eigen::Vector3d& origin,
                            const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                            const Surface& surface) {
  Quad quad;
  quad.origin = where.Point(origin);
  quad.u = where.Direction(u);
  quad.v = where.Direction(v);
  quad.texture = surface.texture;
  quad.tint = surface.tint;
  quad.gloss = surface.gloss;
  const Texture::Level& level = scene_.textures[surface.texture].levels[0];
  if (surface.texels_per_m > 0) {
    // The grain of a material runs along the longer side.
    if (quad.u.norm() < quad.v.norm()) {
      quad.origin += quad.u;
      const Eigen::Vector3d turned = -quad.u;
      quad.u = quad.v;
      quad.v = turned;
    }
    quad.texel_offset = {static_cast<double>(random_.Below(level.width)),
                         static_cast<double>(random_.Below(level.height))};
    quad.texel_scale = {surface.texels_per_m * quad.u.norm(), surface.texels_per_m * quad.v.norm()};
  } else {
    quad.texel_scale = {static_cast<double>(level.width), static_cast<double>(level.height)};
  }
  scene_.quads.push_back(quad);
  return scene_.quads.back();
}

void SceneBuilder::AddBox(const Placement& where, const Eigen::Vector3d& low,
                          const Eigen::Vector3d& high, const Surface& surface,
                          const std::vector<std::pair<Face, Surface>>& other) {
  const auto look = [&](Face face) {
    for (const auto& [which, s] : other) {
      if (which == face) return s;
    }
    return surface;
  };
  const Eigen::Vector3d d = high - low;
  const Eigen::Vector3d x(d.x(), 0, 0), y(0, d.y(), 0), z(0, 0, d.z());
  AddQuad(where, {high.x(), low.y(), high.z()}, y, -z, look(Face::kRight));
  AddQuad(where, {low.x(), high.y(), high.z()}, -y, -z, look(Face::kLeft));
  AddQuad(where, {high.x(), high.y(), high.z()}, -x, -z, look(Face::kBack));
  AddQuad(where, {low.x(), low.y(), high.z()}, x, -z, look(Face::kFront));
  AddQuad(where, {low.x(), high.y(), high.z()}, x, -y, look(Face::kTop));
  AddQuad(where, {low.x(), low.y(), low.z()}, x, y, look(Face::kBottom));
  for (int i = 0; i < 4; ++i) {
    const double s = i & 1, t = i >> 1;
    const Eigen::Vector3d along_x = low + s * y + t * z;
    const Eigen::Vector3d along_y = low + s * x + t * z;
    const Eigen::Vector3d along_z = low + s * x + t * y;
    AddLine(where, along_x, along_x + x, LineKind::kEdge);
    AddLine(where, along_y, along_y + y, LineKind::kEdge);
    AddLine(where, along_z, along_z + z, LineKind::kEdge);
  }
}

void SceneBuilder::AddLyingSheet(const Placement& where, const Eigen::Vector3d& centre,
                                 double width, double height, double turn_rad,
                                 const Surface& surface, const Surface& rim) {
  const Placement sheet = where.Within(centre, turn_rad);
  AddBox(sheet, {-width / 2, -height / 2, 0}, {width / 2, height / 2, 0.002}, rim,
         {{Face::kTop, surface}});
}

void SceneBuilder::AddPrism(const Placement& where, const Eigen::Vector3d& foot, double radius_low,
                            double radius_high, double height, int sides, const Surface& surface) {
  for (int i = 0; i < sides; ++i) {
    // A parallelogram can't taper: its width is that of the wider end, so that sides overlap
    // instead of leaving gaps.
    const double angle = 2 * std::numbers::pi * (i + 0.5) / sides;
    const double half_width =
        std::max(radius_low, radius_high) * std::tan(std::numbers::pi / sides);
    const Eigen::Vector3d out(std::cos(angle), std::sin(angle), 0);
    const Eigen::Vector3d side(-out.y(), out.x(), 0);
    const Eigen::Vector3d top = foot + radius_high * out + Eigen::Vector3d(0, 0, height);
    const Eigen::Vector3d bottom = foot + radius_low * out;
    AddQuad(where, top - half_width * side, 2 * half_width * side, bottom - top, surface)
        .two_sided = true;
  }
}

void SceneBuilder::AddLine(const Placement& where, const Eigen::Vector3d& a,
                           const Eigen::Vector3d& b, LineKind kind) {
  if ((b - a).norm() < kShortestLine_m) return;
  scene_.lines.push_back({where.Point(a), where.Point(b), kind});
}

void SceneBuilder::AddLamp(const Placement& where, const Eigen::Vector3d& origin,
                           const Eigen::Vector3d& u, const Eigen::Vector3d& v,
                           const Surface& surface, double emission, double radiance) {
  Quad& quad = AddQuad(where, origin, u, v, surface);
  quad.emission = emission;
  quad.casts_shadow = false;
  scene_.lamps.push_back({quad.origin, quad.u, quad.v, radiance});
}

}  // namespace vpslam::simulator
