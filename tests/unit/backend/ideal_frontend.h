// A frontend that makes no mistakes, for tests of the backend.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "backend/mapper.h"
#include "core/estimation/pose_optimizer.h"
#include "core/geometry/so3.h"
#include "core/map/map_replica.h"
#include "tests/unit/synthetic_scene.h"

namespace vpslam {

/// Knows which feature shows what, measures poses in its replica as tracking does, and makes
/// keyframes of all views.
class IdealFrontend {
 public:
  IdealFrontend(uint64_t seed, const SyntheticOptions& options)
      : scene(seed, options), mapper(scene.camera, MapperOptions()) {}

  SyntheticScene scene;
  Mapper mapper;
  MapReplica replica;
  std::map<KeyframeId, SyntheticView> views;
  std::string bytes;  ///< of all deltas
  std::vector<MapDelta> last_answer;
  std::optional<Eigen::Quaterniond> axes;  ///< in the scene, as vanishing points show them

  void Send(const KeyframeProposal& proposal) {
    last_answer = mapper.Process(proposal);
    bytes += BytesOf(last_answer);
    for (const MapDelta& delta : last_answer) ASSERT_TRUE(replica.Apply(delta));
    ASSERT_EQ(last_answer.back().answers, proposal.id);
    ASSERT_EQ(replica.version(), mapper.version());
  }
  void Start(const SE3& a, const SE3& b, MapId discarded = MapId()) {
    map_ = MapId(map_.value + 1);
    worlds_[map_] = a;
    KeyframeProposal first = Propose(scene.Look(a)), second = Propose(scene.Look(b));
    first.role = KeyframeRole::kMapFirst;
    first.discarded_map = discarded;
    second.role = KeyframeRole::kMapSecond;
    const SyntheticView &view_a = views.at(first.id), &view_b = views.at(second.id);
    second.cam_from_world = b * a.Inverse();
    for (int f = 0; f < view_a.features.size(); ++f) {
      const int g = view_a.point[f] < 0 ? -1 : view_b.FeatureOf(view_a.point[f]);
      if (g < 0) continue;
      const Eigen::Vector3d x = a * scene.points[view_a.point[f]].position;
      second.initial_points.push_back({f, g, x + scene.NormalVector(0.03)});
    }
    Send(first);
    Send(second);
  }
  /// `seam_map`: one that shows what the keyframe shows, too.
  void Add(const SE3& truth, MapId seam_map = MapId()) {
    KeyframeProposal proposal = Propose(scene.Look(truth));
    const SyntheticView& view = views.at(proposal.id);
    const std::map<int, PointId> known = Known(map_);
    PoseMeasurements measurements;
    std::vector<int> features;
    for (int f = 0; f < view.features.size(); ++f) {
      const auto at = known.find(view.point[f]);
      if (at == known.end()) continue;
      const Keypoint& k = view.features.keypoints[f];
      measurements.points.push_back(
          {replica.Find(at->second)->position, k.Position(),
           Eigen::Matrix2d::Identity() / scene.scales.sigma_px(k.octave)});
      features.push_back(f);
      proposal.points[f] = at->second;
      proposal.sightings.push_back({at->second, 1, 1});
    }
    const PoseEstimate pose =
        OptimizePose(scene.camera, measurements,
                     scene.Disturbed(truth * worlds_.at(map_).Inverse(), 0.02, 0.005), {});
    proposal.cam_from_world = pose.cam_from_world;
    for (size_t i = 0; i < features.size(); ++i) {
      if (!pose.inliers[i]) proposal.points[features[i]] = PointId();
    }
    proposal.reference = KeyframeId(proposal.id.value - 1);
    if (seam_map.IsValid()) {
      proposal.seam.map = seam_map;
      proposal.seam.cam_from_world = truth * worlds_.at(seam_map).Inverse();
      const std::map<int, PointId> there = Known(seam_map);
      for (int f = 0; f < view.features.size(); ++f) {
        const auto at = there.find(view.point[f]);
        if (at != there.end()) proposal.seam.points.push_back({f, at->second});
      }
    }
    Send(proposal);
  }
  /// What most of its observations show.
  int TruthOf(const MapPoint& point) const {
    std::map<int, int> votes;
    for (const Observation& o : point.observations) ++votes[views.at(o.keyframe).point[o.feature]];
    const auto most = std::max_element(votes.begin(), votes.end(),
                                       [](auto& a, auto& b) { return a.second < b.second; });
    return most == votes.end() ? -1 : most->first;
  }

 private:
  KeyframeProposal Propose(const SyntheticView& view) {
    KeyframeProposal proposal;
    proposal.id = KeyframeId(next_++);
    proposal.map = map_;
    proposal.frame_seq = 7 * proposal.id.value;
    proposal.features = view.features;
    proposal.points.resize(view.features.size());
    if (axes) proposal.lines = Axes(view.cam_from_world.rotation * *axes);
    views[proposal.id] = view;
    return proposal;
  }

  /// By what they are.
  std::map<int, PointId> Known(MapId map) const {
    std::map<int, PointId> known;
    for (int i = 0; i < EndOf(replica.points()); ++i) {
      const MapPoint* point = replica.Find(PointId(i));
      if (point && point->map == map && TruthOf(*point) >= 0) known[TruthOf(*point)] = point->id;
    }
    return known;
  }
  LineSet Axes(const Eigen::Quaterniond& cam_from_manhattan) {
    constexpr double kSigma_rad = 0.002;
    LineSet lines;
    lines.manhattan = ManhattanState::kThree;
    lines.vanishing_points.resize(3);
    for (VanishingPoint& vp : lines.vanishing_points) vp.support = 10;
    lines.cam_from_manhattan = ExpSo3(scene.NormalVector(kSigma_rad)) * cam_from_manhattan;
    lines.covariance_rad2 = kSigma_rad * kSigma_rad * Eigen::Matrix3d::Identity();
    return lines;
  }

  MapId map_;
  std::map<MapId, SE3> worlds_;  ///< of the maps, from that of the scene
  int32_t next_ = 0;
};

/// A way through the scene, with turns.
inline SE3 OnTheWay(int i) {
  return PoseAt({0.25 * i, 0.15 * std::sin(0.7 * i), 0.1 * std::cos(0.5 * i)},
                {0.02 * std::sin(i), 0.1 * std::sin(0.4 * i), 0.03 * std::cos(i)});
}

}  // namespace vpslam
