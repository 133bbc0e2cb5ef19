#include "backend/point_creator.h"

#include <algorithm>
#include <cmath>

#include "backend/point_view.h"
#include "core/estimation/point_residual.h"
#include "core/estimation/robust.h"
#include "core/features/matcher.h"
#include "core/geometry/triangulation.h"
#include "core/map/depth_quantile.h"

namespace vpslam {
namespace {

std::vector<int32_t> FreeFeatures(const Keyframe& keyframe, int num_features) {
  std::vector<int32_t> result;
  for (int32_t i = 0; i < num_features; ++i) {
    if (i >= static_cast<int32_t>(keyframe.points.size()) || !keyframe.points[i].IsValid()) {
      result.push_back(i);
    }
  }
  return result;
}

struct View {
  const SE3& cam_from_world;
  Eigen::Vector3d center;
  const Keypoint& keypoint;
};

/// Is the point in front of the view, and does it project to where the key point is?
bool Agrees(const View& view, const Eigen::Vector3d& point, const Camera& camera,
            const ScalePyramid& scales) {
  const Eigen::Vector3d x = view.cam_from_world * point;
  if (x.z() < kMinDepth) return false;
  const double error2 = (camera.Project(x) - view.keypoint.Position()).squaredNorm();
  return error2 <= kChi2Dof2 * scales.sigma2(view.keypoint.octave);
}

bool Triangulate(const View& a, const View& b, const Camera& camera, const ScalePyramid& scales,
                 const PointCreatorOptions& options, Eigen::Vector3d* point) {
  const Eigen::Vector3d ray_a =
      a.cam_from_world.rotation.conjugate() * camera.Unproject(a.keypoint.Position());
  const Eigen::Vector3d ray_b =
      b.cam_from_world.rotation.conjugate() * camera.Unproject(b.keypoint.Position());
  const double cosine = ray_a.normalized().dot(ray_b.normalized());
  if (cosine <= 0 || cosine >= options.max_parallax_cosine) return false;
  const std::optional<Eigen::Vector3d> in_a = TriangulateTwoView(
      b.cam_from_world * a.cam_from_world.Inverse(),
      MakeRayMatch(camera, a.keypoint.Position(), b.keypoint.Position(),
                   scales.sigma_px(a.keypoint.octave), scales.sigma_px(b.keypoint.octave)));
  if (!in_a) return false;
  const Eigen::Vector3d x = a.cam_from_world.Inverse() * *in_a;
  if (!Agrees(a, x, camera, scales) || !Agrees(b, x, camera, scales)) return false;
  // A corner seen from twice as far is found at half the scale.
  const double distance_ratio = (x - b.center).norm() / (x - a.center).norm();
  const double octave_ratio = scales.scale(a.keypoint.octave) / scales.scale(b.keypoint.octave);
  const double mismatch = distance_ratio / octave_ratio;
  if (mismatch > options.max_scale_mismatch || mismatch < 1 / options.max_scale_mismatch) {
    return false;
  }
  *point = x;
  return true;
}

}  // namespace

std::vector<PointId> CreatePoints(const MappingContext& context, KeyframeId id,
                                  const PointCreatorOptions& options) {
  const auto& [camera, bounds, scales, owned_map] = context;
  OwnedMap* map = &owned_map;
  std::vector<PointId> created;
  const Features& features = map->Find(id)->seen->features;
  auto neighbours = map->Covisible(id, 1);
  if (static_cast<int>(neighbours.size()) > options.neighbours) {
    neighbours.resize(options.neighbours);
  }
  TriangulationMatchOptions matching;
  matching.max_distance = options.max_distance;
  matching.ratio = static_cast<float>(options.ratio);
  matching.max_parallax_rad = options.max_parallax_rad;
  matching.min_depth = options.min_depth_share * DepthQuantile(*map, id, 0.05);
  for (const auto& [neighbour_id, shared] : neighbours) {
    const Keyframe& keyframe = *map->Find(id);
    const Keyframe& neighbour = *map->Find(neighbour_id);
    const double baseline = (keyframe.Center() - neighbour.Center()).norm();
    if (baseline < options.min_baseline_per_depth * DepthQuantile(*map, neighbour_id, 0.5))
      continue;
    const Features& neighbour_features = neighbour.seen->features;
    const std::vector<int32_t> free = FreeFeatures(keyframe, features.size());
    const std::vector<int32_t> neighbour_free = FreeFeatures(neighbour, neighbour_features.size());
    const SE3 neighbour_from_keyframe =
        neighbour.cam_from_world * keyframe.cam_from_world.Inverse();
    const std::vector<Match> matches =
        MatchForTriangulation(features, free, neighbour_features, neighbour_free,
                              neighbour_from_keyframe, camera, scales, matching);
    for (const Match& match : matches) {
      Eigen::Vector3d position;
      if (!Triangulate(
              {keyframe.cam_from_world, keyframe.Center(), features.keypoints[match.first]},
              {neighbour.cam_from_world, neighbour.Center(),
               neighbour_features.keypoints[match.second]},
              camera, scales, options, &position)) {
        continue;
      }
      const PointId point = map->CreatePoint(keyframe.map, id, position);
      map->Observe(id, match.first, point);
      map->Observe(neighbour_id, match.second, point);
      UpdateView(point, scales, map);
      UpdateDescriptor(point, map);
      created.push_back(point);
    }
  }
  return created;
}

}  // namespace vpslam
