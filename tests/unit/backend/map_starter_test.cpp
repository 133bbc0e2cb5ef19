#include "backend/map_starter.h"

#include <gtest/gtest.h>

#include "core/geometry/triangulation.h"
#include "tests/unit/synthetic_scene.h"

namespace vpslam {
namespace {

constexpr double kUnit = 0.2;  // of the map, per unit of the scene: the median depth is about 1

/// Two views of a scene and what an initialiser would make of them.
struct Fixture {
  explicit Fixture(uint64_t seed, double motion_error = 0.01, const SyntheticOptions& options = {})
      : scene(seed, options) {
    const SyntheticView a = scene.Look(PoseAt({0, 0, 0}));
    const SyntheticView b = scene.Look(PoseAt({0.5, 0.05, 0.05}, {0.01, -0.06, 0.02}));
    first = MakeProposal(a, 0);
    second = MakeProposal(b, 1);
    truth = b.cam_from_world;
    truth.translation *= kUnit;
    // The motion as found is off in turn and direction; its length is the unit.
    second.cam_from_world =
        scene.Disturbed(truth, motion_error * truth.translation.norm(), 0.1 * motion_error);
    for (int f = 0; f < a.features.size(); ++f) {
      const int g = a.point[f] < 0 ? -1 : b.FeatureOf(a.point[f]);
      if (g < 0) continue;
      const auto x = TriangulateTwoView(
          second.cam_from_world, MakeRayMatch(scene.camera, a.features.keypoints[f].Position(),
                                              b.features.keypoints[g].Position(), 1, 1));
      if (!x) continue;
      second.initial_points.push_back({f, g, *x});
      points.push_back(a.point[f]);
    }
  }
  KeyframeProposal MakeProposal(const SyntheticView& view, int id) {
    KeyframeProposal proposal;
    proposal.id = KeyframeId(id);
    proposal.map = MapId(3);
    proposal.frame_seq = 100 + 5 * id;
    proposal.stamp_us = 1000 + id;
    proposal.features = view.features;
    return proposal;
  }
  std::vector<PointId> Start() {
    return StartMap({scene.camera, scene.bounds, scene.scales, map}, first, second,
                    LocalBaOptions());
  }

  SyntheticScene scene;
  KeyframeProposal first, second;
  SE3 truth;
  std::vector<int> points;  ///< of the scene, per initial point
  OwnedMap map;
};

TEST(MapStarter, TwoKeyframesAndTheirPoints) {
  Fixture f(1);
  const std::vector<PointId> ids = f.Start();
  ASSERT_EQ(ids.size(), f.points.size());
  ASSERT_GT(ids.size(), 200u);
  const Keyframe& a = *f.map.Find(KeyframeId(0));
  const Keyframe& b = *f.map.Find(KeyframeId(1));
  EXPECT_FALSE(a.parent.IsValid());
  EXPECT_EQ(b.parent, KeyframeId(0));
  EXPECT_EQ(b.map, MapId(3));
  EXPECT_EQ(b.frame_seq, 105);
  EXPECT_EQ(b.stamp_us, 1001);
  EXPECT_EQ(a.cam_from_world.translation, Eigen::Vector3d::Zero());
  EXPECT_EQ(a.cam_from_world.rotation.coeffs(), Eigen::Quaterniond::Identity().coeffs());
  for (size_t i = 0; i < ids.size(); ++i) {
    const MapPoint* point = f.map.Find(ids[i]);
    if (!point) continue;
    EXPECT_EQ(point->observations.size(), 2u);
    EXPECT_EQ(a.points[f.second.initial_points[i].feature_in_first], ids[i]);
    EXPECT_EQ(b.points[f.second.initial_points[i].feature_in_second], ids[i]);
    EXPECT_GT(point->max_distance, 0);
    EXPECT_LE(Distance(point->descriptor, f.scene.points[f.points[i]].descriptor), 8);
    EXPECT_NEAR(point->normal.norm(), 1, 1e-9);
  }
  EXPECT_GT(f.map.NumPoints(MapId(3)), static_cast<int>(0.85 * ids.size()));
}

TEST(MapStarter, AdjustsMotionAndStructureAndKeepsTheUnit) {
  for (const auto shape : {SyntheticShape::kVolume, SyntheticShape::kSlantedPlane}) {
    Fixture f(2, 0.1, {.shape = shape});
    const double length = f.second.cam_from_world.translation.norm();
    const std::vector<PointId> ids = f.Start();
    const SE3& pose = f.map.Find(KeyframeId(1))->cam_from_world;
    EXPECT_LT(AngleBetween_rad(pose.rotation, f.truth.rotation), 0.005);  // was about 0.017
    const double direction_rad = std::atan2(pose.translation.cross(f.truth.translation).norm(),
                                            pose.translation.dot(f.truth.translation));
    EXPECT_LT(direction_rad, 0.03);
    EXPECT_NEAR(pose.translation.norm() / length, 1, 0.1);  // by as much as the motion was off
    std::vector<double> errors;
    const double scale = pose.translation.norm() / f.truth.translation.norm();
    for (size_t i = 0; i < ids.size(); ++i) {
      const Eigen::Vector3d& truth = kUnit * f.scene.points[f.points[i]].position;
      if (const MapPoint* point = f.map.Find(ids[i])) {
        errors.push_back((point->position / scale - truth).norm() / truth.norm());
      }
    }
    std::sort(errors.begin(), errors.end());
    // 1.3 px of either image, against a disparity of 50 px.
    EXPECT_LT(errors[errors.size() / 2], 2 * 1.3 * std::sqrt(2.0) / 50);
  }
}

TEST(MapStarter, WrongPointsDoNotStay) {
  Fixture f(3);
  // Matched with what is 30 px off, across the epipolar lines.
  for (size_t i = 0; i < f.points.size(); i += 8) {
    const int feature = f.second.initial_points[i].feature_in_second;
    Keypoint& k = f.second.features.keypoints[feature];
    k.y_px += 30 * static_cast<float>(f.scene.scales.scale(k.octave));
  }
  const std::vector<PointId> ids = f.Start();
  int right = 0;
  for (size_t i = 0; i < ids.size(); ++i) {
    if (i % 8 == 0) {
      EXPECT_EQ(f.map.Find(ids[i]), nullptr);
    } else {
      right += f.map.Find(ids[i]) != nullptr;
    }
  }
  EXPECT_GT(right, 0.75 * static_cast<double>(ids.size()));
}

TEST(MapStarter, SameInputSameBytes) {
  const auto run = [] {
    Fixture f(4);
    f.Start();
    return BytesOf(f.map.TakeDeltas(KeyframeId(1), {}));
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace vpslam
