#include "frontend/initializer.h"

#include <gtest/gtest.h>

#include "tests/unit/synthetic_scene.h"

namespace vpslam {
namespace {

/// Initialisation looks on the finest octave.
SyntheticOptions Fine(SyntheticShape shape = SyntheticShape::kVolume) {
  return {.shape = shape, .num_points = 900, .finest_only = true};
}

class Fixture {
 public:
  Fixture(uint64_t seed, const SyntheticOptions& options,
          const InitializerOptions& initializer = {})
      : scene(seed, options), initializer_(scene.camera, scene.scales, initializer), rng_(seed) {}

  std::optional<InitialMap> Add(const SE3& pose, std::shared_ptr<const LineSet> lines = nullptr) {
    views.push_back(scene.Look(pose));
    Frame frame;
    frame.seen = FrameObservation::Make(static_cast<int64_t>(views.size()) - 1, 0,
                                        views.back().features, scene.bounds, std::move(lines));
    return initializer_.Add(frame, rng_);
  }

  /// Motion, unit and points, against the truth of the two views.
  void ExpectRight(const InitialMap& map, double max_direction_rad) const {
    const SyntheticView &a = views[map.first.seq()], &b = views.back();
    const SE3 truth = b.cam_from_world * a.cam_from_world.Inverse();
    const SE3& found = map.second_from_first;
    EXPECT_LT(AngleBetween_rad(found.rotation, truth.rotation), 0.01);
    EXPECT_LT(std::atan2(found.translation.cross(truth.translation).norm(),
                         found.translation.dot(truth.translation)),
              max_direction_rad);
    ASSERT_GE(map.points.size(), 50u);
    std::vector<double> depths, errors;
    int wrong = 0;
    const double scale = found.translation.norm() / truth.translation.norm();
    for (const InitialPoint& p : map.points) {
      depths.push_back(p.position_in_world.z());
      const int of_a = a.point[p.feature_in_first], of_b = b.point[p.feature_in_second];
      wrong += of_a < 0 || of_a != of_b;
      if (of_a < 0 || of_a != of_b) continue;
      const double z = (a.cam_from_world * scene.points[of_a].position).z();
      errors.push_back(std::abs(p.position_in_world.z() / scale - z) / z);
    }
    std::sort(depths.begin(), depths.end());
    std::sort(errors.begin(), errors.end());
    EXPECT_DOUBLE_EQ(depths[depths.size() / 2], 1);
    EXPECT_LT(errors[errors.size() / 2], 0.1);
    EXPECT_LT(wrong, 0.03 * static_cast<double>(map.points.size()));
  }

  SyntheticScene scene;
  std::vector<SyntheticView> views;

 private:
  Initializer initializer_;
  std::mt19937_64 rng_;
};

SE3 Sideways(double along) { return PoseAt({along, 0.1 * along, 0}, {0, -0.02 * along, 0}); }

TEST(Initializer, AMovingCameraStartsAMap) {
  for (const double outlier_share : {0.0, 0.2}) {
    SyntheticOptions options = Fine();
    options.outlier_share = outlier_share;
    options.clutter = 100;
    Fixture f(1, options);
    std::optional<InitialMap> map;
    for (int i = 0; i < 30 && !map; ++i) map = f.Add(Sideways(0.05 * i));
    ASSERT_TRUE(map) << outlier_share;
    EXPECT_EQ(map->first.seq(), 0) << "the reference is kept while it is followed";
    f.ExpectRight(*map, 0.15);
    // One degree of parallax is the least: of 5 units of depth that is 0.087.
    EXPECT_GE(f.views.back().cam_from_world.Center().norm(), 0.08);
  }
}

TEST(Initializer, ARotatingCameraDoesNot) {
  for (const auto shape : {SyntheticShape::kVolume, SyntheticShape::kFrontoParallel}) {
    Fixture f(2, Fine(shape));
    for (int i = 0; i < 25; ++i) {
      EXPECT_FALSE(f.Add(PoseAt({0, 0, 0}, {0.05 * std::sin(0.5 * i), 0.015 * i, 0})));
    }
  }
}

TEST(Initializer, ACameraThatStandsStillDoesNot) {
  Fixture f(3, Fine());
  for (int i = 0; i < 25; ++i) EXPECT_FALSE(f.Add(PoseAt({0, 0, 0})));
  // Nor with a tremor far below the parallax that is asked for.
  for (int i = 0; i < 25; ++i) EXPECT_FALSE(f.Add(PoseAt({0.01 * (i % 3), 0.01 * (i % 2), 0})));
}

TEST(Initializer, PlanesStartRightOrNotAtAll) {
  int started = 0;
  for (const auto shape : {SyntheticShape::kSlantedPlane, SyntheticShape::kFrontoParallel}) {
    for (uint64_t seed = 10; seed < 13; ++seed) {
      Fixture f(seed, Fine(shape));
      std::optional<InitialMap> map;
      for (int i = 0; i < 15 && !map; ++i) {
        map = f.Add(PoseAt({0.08 * i, 0, 0.02 * i}, {0.002 * i, 0.003 * i, 0}));
      }
      if (!map) continue;
      ++started;
      f.ExpectRight(*map, 0.2);
    }
  }
  EXPECT_GE(started, 1);
}

/// What a view shows of the axes of the world, turned by that.
std::shared_ptr<const LineSet> Axes(const SE3& pose, const Eigen::Vector3d& turn_rad) {
  LineSet lines;
  lines.manhattan = ManhattanState::kThree;
  lines.vanishing_points.resize(3);
  for (VanishingPoint& vp : lines.vanishing_points) vp.support = 10;
  lines.cam_from_manhattan = ExpSo3(turn_rad) * pose.rotation;
  lines.covariance_rad2 = 1e-6 * Eigen::Matrix3d::Identity();
  return std::make_shared<const LineSet>(lines);
}

TEST(Initializer, AxesDecideBetweenTheMotionsOfAPlane) {
  int with = 0, without = 0;
  for (uint64_t seed = 10; seed < 16; ++seed) {
    for (const bool axes : {false, true}) {
      Fixture f(seed, Fine(SyntheticShape::kSlantedPlane));
      std::optional<InitialMap> map;
      for (int i = 0; i < 15 && !map; ++i) {
        const SE3 pose = PoseAt({0.08 * i, 0, 0.02 * i}, {0.002 * i, 0.003 * i, 0});
        map = f.Add(pose, axes ? Axes(pose, Eigen::Vector3d::Zero()) : nullptr);
      }
      // How soon.
      (axes ? with : without) += map ? static_cast<int>(f.views.size()) : 15;
      SCOPED_TRACE(testing::Message()
                   << seed << (axes ? " with axes" : " without") << " after " << f.views.size());
      if (map) f.ExpectRight(*map, 0.2);
    }
  }
  EXPECT_LT(with, without);
}

TEST(Initializer, AxesHaveNoSayAgainstAClearMotion) {
  Fixture f(1, Fine());
  std::optional<InitialMap> map;
  for (int i = 0; i < 30 && !map; ++i) {
    const SE3 pose = Sideways(0.05 * i);
    map = f.Add(pose, Axes(pose, Eigen::Vector3d(0, 0.02 * i, 0)));
  }
  ASSERT_TRUE(map);
  f.ExpectRight(*map, 0.15);
}

TEST(Initializer, TheReferenceIsRenewedWhenItIsOld) {
  InitializerOptions options;
  options.max_frames = 5;
  Fixture f(4, Fine(), options);
  for (int i = 0; i < 7; ++i) EXPECT_FALSE(f.Add(PoseAt({0, 0, 0})));
  // Frames 1 to 5 were tried against frame 0; frame 6 is the new reference.
  std::optional<InitialMap> map = f.Add(Sideways(0.6));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->first.seq(), 6);
}

TEST(Initializer, TheReferenceIsRenewedWhenTheViewChanges) {
  Fixture f(5, Fine());
  EXPECT_FALSE(f.Add(PoseAt({0, 0, 0})));
  EXPECT_FALSE(f.Add(PoseAt({0, 0, 0}, {0, 0.9, 0})));  // nothing in common
  EXPECT_FALSE(f.Add(PoseAt({0, 0, 0}, {0, 0.0, 0})));  // nor again
  const auto map = f.Add(Sideways(0.6));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->first.seq(), 2);
}

TEST(Initializer, EmptyImagesAreNoReference) {
  Fixture f(6, Fine());
  EXPECT_FALSE(f.Add(PoseAt({0, 0, 0})));
  EXPECT_FALSE(f.Add(PoseAt({0, 0, 0}, {0, M_PI, 0})));  // looks away: no feature
  EXPECT_EQ(f.views.back().features.size(), 0);
  EXPECT_FALSE(f.Add(Sideways(0.6))) << "there is no reference to try it against";
  const auto map = f.Add(Sideways(0));
  ASSERT_TRUE(map);
  EXPECT_EQ(map->first.seq(), 2);
}

TEST(Initializer, SameInputSameMap) {
  const auto run = [] {
    SyntheticOptions options = Fine();
    options.outlier_share = 0.1;
    Fixture f(7, options);
    std::optional<InitialMap> map;
    for (int i = 0; i < 30 && !map; ++i) map = f.Add(Sideways(0.05 * i));
    return *map;
  };
  const InitialMap a = run(), b = run();
  EXPECT_EQ(a.first.seen->frame_seq, b.first.seen->frame_seq);
  EXPECT_EQ(a.second_from_first.translation, b.second_from_first.translation);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (size_t i = 0; i < a.points.size(); ++i) {
    EXPECT_EQ(a.points[i].position_in_world, b.points[i].position_in_world);
  }
}

}  // namespace
}  // namespace vpslam
