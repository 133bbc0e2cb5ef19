#include "backend/map_joiner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include "core/base/thin_out.h"
#include "core/estimation/point_residual.h"
#include "core/geometry/chi_square.h"

namespace vpslam {
namespace {

/// A point of one map as a keyframe of the other sees it.
struct CrossSighting {
  int common = -1;       ///< index of the common point; -1: no common one
  bool of_here = false;  ///< the point is one of `here`, seen by a keyframe of `there`
  Eigen::Vector3d position;
  SE3 cam_from_world;
  Eigen::Vector2d px;
  double inv_sigma_px = 1;
};

/// Parameters of the similarity that takes x to exp(p[6]) R(p[0..2]) x + p[3..5].
using Parameters = std::array<double, 7>;

Parameters ToParameters(const Sim3& s) {
  Parameters p;
  const double q[4] = {s.rotation.w(), s.rotation.x(), s.rotation.y(), s.rotation.z()};
  ceres::QuaternionToAngleAxis(q, p.data());
  std::copy_n(s.translation.data(), 3, &p[3]);
  p[6] = std::log(s.scale);
  return p;
}

Sim3 FromParameters(const Parameters& p) {
  double q[4];
  ceres::AngleAxisToQuaternion(p.data(), q);
  return {Eigen::Quaterniond(q[0], q[1], q[2], q[3]), {p[3], p[4], p[5]}, std::exp(p[6])};
}

struct CrossCost {
  const Camera& camera;
  const CrossSighting& sighting;

  template <class T>
  bool operator()(const T* p, T* residual) const {
    const T scale = ceres::exp(p[6]);
    T x[3], y[3], turn[3] = {p[0], p[1], p[2]};
    for (int i = 0; i < 3; ++i) x[i] = T(sighting.position[i]);
    if (sighting.of_here) {
      ceres::AngleAxisRotatePoint(turn, x, y);
      for (int i = 0; i < 3; ++i) y[i] = scale * y[i] + p[3 + i];
    } else {
      for (int i = 0; i < 3; ++i) turn[i] = -turn[i];
      for (int i = 0; i < 3; ++i) x[i] = (x[i] - p[3 + i]) / scale;
      ceres::AngleAxisRotatePoint(turn, x, y);
    }
    const Eigen::Matrix3d r = sighting.cam_from_world.RotationMatrix();
    const Eigen::Vector3d& t = sighting.cam_from_world.translation;
    T c[3];
    for (int i = 0; i < 3; ++i) c[i] = r(i, 0) * y[0] + r(i, 1) * y[1] + r(i, 2) * y[2] + t[i];
    if (c[2] < T(kMinDepth)) return false;
    residual[0] = sighting.inv_sigma_px * (camera.fx * c[0] / c[2] + camera.cx - sighting.px.x());
    residual[1] = sighting.inv_sigma_px * (camera.fy * c[1] / c[2] + camera.cy - sighting.px.y());
    return true;
  }
};

class Aligner {
 public:
  explicit Aligner(const MappingContext& context)
      : camera_(context.camera), scales_(context.scales), map_(context.map) {}

  void Add(int common, const CommonPoint& point) {
    const MapPoint &here = *map_.Find(point.here), &there = *map_.Find(point.there);
    AddSightings(common, true, here.position, there);
    AddSightings(common, false, there.position, here);
  }

  /// What the keyframe of the seam itself sees of the other map. It says where the camera stands
  /// there much better than a few common points do, which may be close to each other.
  void AddSeam(const Keyframe& keyframe, const MapSeam& seam) {
    const std::vector<Keypoint>& keypoints = keyframe.seen->features.keypoints;
    for (const auto& [feature, id] : seam.points) {
      const MapPoint* there = map_.Find(map_.Resolve(id));
      if (!there || there->map == keyframe.map) continue;
      const Keypoint& k = keypoints[feature];
      sightings_.push_back({-1, false, there->position, keyframe.cam_from_world, k.Position(),
                            1 / scales_.sigma_px(k.octave)});
    }
  }

  /// Residuals that lie behind a camera have no cost to begin with, and stay out.
  Sim3 Refine(const Sim3& start) const {
    Parameters p = ToParameters(start);
    ceres::Problem problem;
    for (const CrossSighting& s : sightings_) {
      const CrossCost cost{camera_, s};
      double residual[2];
      if (!cost(p.data(), residual)) continue;
      problem.AddResidualBlock(
          new ceres::AutoDiffCostFunction<CrossCost, 2, 7>(new CrossCost(cost)),
          new ceres::HuberLoss(std::sqrt(kChi2Dof2)), p.data());
    }
    if (problem.NumResidualBlocks() == 0) return start;
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.dense_linear_algebra_library_type = ceres::EIGEN;
    options.num_threads = 1;
    options.max_num_iterations = 30;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    return FromParameters(p);
  }

  /// Of each common point: most of those who see its double see it there as well.
  std::vector<uint8_t> Agreeing(const Sim3& there_from_here, int num_common,
                                double max_sigmas) const {
    const Parameters p = ToParameters(there_from_here);
    std::vector<int> seen(num_common, 0), fits(num_common, 0);
    for (const CrossSighting& s : sightings_) {
      double r[2];
      if (s.common < 0) continue;
      ++seen[s.common];
      if (!CrossCost{camera_, s}(p.data(), r)) continue;
      fits[s.common] += r[0] * r[0] + r[1] * r[1] < kChi2Dof2 * max_sigmas * max_sigmas;
    }
    std::vector<uint8_t> agreeing(num_common);
    for (int i = 0; i < num_common; ++i) agreeing[i] = seen[i] > 0 && 2 * fits[i] > seen[i];
    return agreeing;
  }

 private:
  void AddSightings(int common, bool of_here, const Eigen::Vector3d& position,
                    const MapPoint& double_of_it) {
    // More sightings add little information.
    constexpr size_t kMaxSightings = 6;
    const auto& observations = double_of_it.observations;
    const size_t step = ThinOutStep(observations.size(), kMaxSightings);
    for (size_t i = 0; i < observations.size(); i += step) {
      const Observation& o = observations[i];
      const Keyframe& keyframe = *map_.Find(o.keyframe);
      const Keypoint& k = keyframe.seen->features.keypoints[o.feature];
      sightings_.push_back({common, of_here, position, keyframe.cam_from_world, k.Position(),
                            1 / scales_.sigma_px(k.octave)});
    }
  }

  const Camera& camera_;
  const ScalePyramid& scales_;
  const Map& map_;
  std::vector<CrossSighting> sightings_;
};

/// From where the keyframe stands in both, and the ratio of depths.
Sim3 FirstGuess(const Keyframe& keyframe, const SE3& cam_from_there,
                const std::vector<CommonPoint>& common, const Map& map) {
  std::vector<double> ratios;
  for (const CommonPoint& c : common) {
    ratios.push_back((cam_from_there * map.Find(c.there)->position).z() /
                     (keyframe.cam_from_world * map.Find(c.here)->position).z());
  }
  const auto middle = ratios.begin() + static_cast<int>(ratios.size()) / 2;
  std::nth_element(ratios.begin(), middle, ratios.end());
  const Sim3 cam_from_here{keyframe.cam_from_world.rotation, keyframe.cam_from_world.translation};
  const SE3 there_from_cam = cam_from_there.Inverse();
  return Sim3{there_from_cam.rotation, there_from_cam.translation} *
         Sim3{Eigen::Quaterniond::Identity(), Eigen::Vector3d::Zero(), *middle} * cam_from_here;
}

}  // namespace

std::optional<SeamAlignment> AlignSeam(const MappingContext& context, KeyframeId keyframe_id,
                                       const MapSeam& seam, const MergingOptions& options) {
  const Map& map = context.map;
  const Keyframe& keyframe = *map.Find(keyframe_id);
  const MapId there = map.Resolve(seam.map);
  std::vector<CommonPoint> common;
  for (const auto& [feature, point] : seam.points) {
    const MapPoint* a = map.Find(keyframe.points[feature]);
    const MapPoint* b = map.Find(map.Resolve(point));
    if (!a || !b || b->map != there || a->map == there) continue;
    if ((keyframe.cam_from_world * a->position).z() < kMinDepth ||
        (seam.cam_from_world * b->position).z() < kMinDepth) {
      continue;
    }
    common.push_back({a->id, b->id});
  }
  const auto num_common = static_cast<int>(common.size());
  if (num_common < options.min_common_points) return std::nullopt;
  Sim3 there_from_here = FirstGuess(keyframe, seam.cam_from_world, common, map);
  // Those far off would not be outvoted for good by the robust loss.
  std::vector<uint8_t> use(num_common, 1);
  for (const double sigmas : {2 * options.max_sigmas, options.max_sigmas}) {
    Aligner aligner(context), all(context);
    for (int i = 0; i < num_common; ++i) {
      if (use[i]) aligner.Add(i, common[i]);
      all.Add(i, common[i]);
    }
    aligner.AddSeam(keyframe, seam);
    there_from_here = aligner.Refine(there_from_here);
    use = all.Agreeing(there_from_here, num_common, sigmas);
  }
  SeamAlignment alignment{there_from_here, {}};
  for (int i = 0; i < num_common; ++i) {
    if (use[i]) alignment.points.push_back(common[i]);
  }
  const auto agreeing = static_cast<int>(alignment.points.size());
  if (agreeing < options.min_common_points || agreeing < options.min_share * num_common) {
    return std::nullopt;
  }
  return alignment;
}

MapContents ContentsOf(MapId id, const Map& map) {
  MapContents contents;
  const auto collect = [id](const auto& table, auto* ids) {
    for (const auto& each : table) {
      if (each.map == id) ids->push_back(each.id);
    }
  };
  collect(map.keyframes(), &contents.keyframes);
  collect(map.points(), &contents.points);
  collect(map.lines(), &contents.lines);
  return contents;
}

void Transform(const MapContents& contents, const SE3& new_from_old, OwnedMap* map) {
  const SE3 old_from_new = new_from_old.Inverse();
  for (const KeyframeId id : contents.keyframes) {
    if (const Keyframe* keyframe = map->Find(id)) {
      map->SetPose(id, keyframe->cam_from_world * old_from_new);
    }
  }
  for (const PointId id : contents.points) {
    if (const MapPoint* point = map->Find(id)) {
      map->SetPosition(id, new_from_old * point->position);
      map->SetView(id, new_from_old.rotation * point->normal, point->max_distance);
    }
  }
  for (const LineId id : contents.lines) {
    if (const MapLine* line = map->Find(id)) {
      map->SetEnds(id, new_from_old * line->start, new_from_old * line->end);
    }
  }
}

Merger MergerOf(MapId here, MapId there, const Sim3& there_from_here) {
  return there < here ? Merger{here, there, there_from_here}
                      : Merger{there, here, there_from_here.Inverse()};
}

void JoinMaps(const Merger& merger, const std::vector<CommonPoint>& common, OwnedMap* map) {
  map->Transform(merger.from, merger.into_from);
  map->Absorb(merger.from, merger.into);
  for (const CommonPoint& c : common) {
    // Two of them may have been one point there: fused by now.
    const MapPoint *here = map->Find(map->Resolve(c.here)),
                   *other = map->Find(map->Resolve(c.there));
    if (!here || !other || here == other) continue;
    const bool here_stays = here->observations.size() > other->observations.size();
    map->Fuse(here_stays ? other->id : here->id, here_stays ? here->id : other->id);
  }
}

}  // namespace vpslam
