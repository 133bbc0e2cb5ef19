#include "backend/point_creator.h"

#include <set>

#include <gtest/gtest.h>

#include "core/estimation/point_residual.h"
#include "core/geometry/triangulation.h"
#include "tests/unit/synthetic_scene.h"

namespace vpslam {
namespace {

constexpr int kKnown = 100;  // points of the scene that are in the map already

/// Two keyframes at their true places; the new one is the second.
struct Pair {
  Pair(uint64_t seed, const SyntheticOptions& options, const SE3& second)
      : scene(seed, options), map(scene) {
    map.AddKeyframe(scene.Look(PoseAt({0, 0, 0})));
    map.AddKeyframe(scene.Look(second));
    map.AddPoints(0, kKnown);
    map.map.TakeDeltas(KeyframeId(), {});
  }
  std::vector<PointId> Create(const PointCreatorOptions& options = {}) {
    return CreatePoints(map.Context(), KeyframeId(KeyframeEnd(map.map) - 1), options);
  }
  /// What the point is in truth; -1 if its observations are of different points, or of none.
  int TruthOf(PointId id) const {
    int truth = -2;
    for (const Observation& o : map.map.Find(id)->observations) {
      const int p = map.views.at(o.keyframe).point[o.feature];
      if (truth != -2 && truth != p) return -1;
      truth = p;
    }
    return truth;
  }
  /// Squared error over covariance, which is that of the noise in both images: chi-square with
  /// three degrees of freedom.
  double Chi2(PointId id) const {
    const MapPoint& point = *map.map.Find(id);
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    const Eigen::Vector3d& truth = scene.points[TruthOf(id)].position;
    for (const Observation& o : point.observations) {
      const SyntheticView& view = map.views.at(o.keyframe);
      const Eigen::Matrix<double, 2, 3> j =
          ProjectionJacobian(scene.camera, view.cam_from_world * truth) *
          view.cam_from_world.RotationMatrix();
      information +=
          j.transpose() * j / scene.scales.sigma2(view.features.keypoints[o.feature].octave);
    }
    const Eigen::Vector3d error = point.position - truth;
    return error.dot(information * error);
  }
  int NumCommon() const {
    int common = 0;
    for (int p = kKnown; p < static_cast<int>(scene.points.size()); ++p) {
      common += map.views.at(KeyframeId(0)).FeatureOf(p) >= 0 &&
                map.views.at(KeyframeId(1)).FeatureOf(p) >= 0;
    }
    return common;
  }

  SyntheticScene scene;
  SyntheticMap map;
};

SE3 Sideways() { return PoseAt({0.6, 0.05, 0.1}, {0.01, -0.05, 0.02}); }

TEST(PointCreator, ErrorsAgreeWithTheNoise) {
  for (const auto shape :
       {SyntheticShape::kVolume, SyntheticShape::kSlantedPlane, SyntheticShape::kFrontoParallel}) {
    Pair pair(1, {.shape = shape}, Sideways());
    const std::vector<PointId> created = pair.Create();
    // The gate along the epipolar line knows the noise of one of the images: 83 % pass it.
    EXPECT_GT(static_cast<int>(created.size()), 0.74 * pair.NumCommon());
    double sum = 0;
    int wrong = 0;
    for (const PointId id : created) {
      ASSERT_EQ(pair.map.map.Find(id)->observations.size(), 2u);
      if (pair.TruthOf(id) < 0) {
        ++wrong;
      } else {
        sum += pair.Chi2(id);
      }
    }
    EXPECT_EQ(wrong, 0);
    // Mean 3, with a standard deviation of sqrt(6 / n), n > 200; the gates take away the tails.
    EXPECT_NEAR(sum / static_cast<double>(created.size()), 2.9, 0.5);
  }
}

TEST(PointCreator, KnowsItsViewAndItsLooks) {
  Pair pair(2, {.noise_sigmas = 0, .descriptor_bits = 0}, Sideways());
  const std::vector<PointId> created = pair.Create();
  ASSERT_GT(created.size(), 100u);
  for (const PointId id : created) {
    const MapPoint& point = *pair.map.map.Find(id);
    const SyntheticPoint& truth = pair.scene.points[pair.TruthOf(id)];
    EXPECT_EQ(point.descriptor, truth.descriptor);
    EXPECT_EQ(point.reference, KeyframeId(1));
    EXPECT_LT((point.position - truth.position).norm(), 1e-3);
    // Half an octave is what rounding leaves open, a tenth is what the scene does at the ends.
    EXPECT_LT(std::abs(std::log(point.max_distance / truth.max_distance)), std::log(1.101));
    EXPECT_GT(point.normal.dot((-point.position).normalized()), 0.98);
  }
}

TEST(PointCreator, PureRotationCreatesNothing) {
  // The pose of the second view is known up to noise only, so there seems to be some baseline.
  for (const double seeming_baseline : {0.0, 1e-4, 0.01, 0.04}) {
    Pair pair(3, {}, PoseAt({0, 0, 0}, {0.02, 0.08, 0.01}));
    const SE3 truth = pair.map.map.Find(KeyframeId(1))->cam_from_world;
    pair.map.map.SetPose(KeyframeId(1),
                         SE3(truth.rotation, Eigen::Vector3d(seeming_baseline, 0, 0)));
    EXPECT_TRUE(pair.Create().empty()) << seeming_baseline;
  }
}

TEST(PointCreator, ParallaxDecidesWhatIsAPoint) {
  // 0.09 is seen under 1.7 degrees from 3 away and 0.65 degrees from 8: the limit lies in between.
  const Eigen::Vector3d center(0.09, 0, 0);
  Pair pair(4, {.noise_sigmas = 0.05}, PoseAt(center));
  const std::vector<PointId> created = pair.Create();
  const auto parallax_rad = [&](int p) {
    return Parallax_rad(pair.scene.points[p].position, {0, 0, 0}, center);
  };
  std::set<int> are_points;
  for (const PointId id : created) are_points.insert(pair.TruthOf(id));
  int expected = 0, missed = 0;
  for (int p = kKnown; p < static_cast<int>(pair.scene.points.size()); ++p) {
    const bool common = pair.map.views.at(KeyframeId(0)).FeatureOf(p) >= 0 &&
                        pair.map.views.at(KeyframeId(1)).FeatureOf(p) >= 0;
    if (!common) continue;
    if (parallax_rad(p) < 0.0195) {
      EXPECT_EQ(are_points.count(p), 0u);
    }
    if (parallax_rad(p) < 0.0205) continue;
    ++expected;
    missed += are_points.count(p) == 0;
  }
  EXPECT_GT(expected, 15);
  EXPECT_LE(missed, 1);
  EXPECT_TRUE(pair.Create({.max_parallax_cosine = 0.999}).empty());
}

TEST(PointCreator, NothingNearTheEpipole) {
  Pair pair(5, {.noise_sigmas = 0.3}, PoseAt({0, 0, 1.2}));
  const std::vector<PointId> created = pair.Create();
  EXPECT_GT(created.size(), 80u);
  for (const PointId id : created) {
    const Observation& o = pair.map.map.Find(id)->observations.front();
    const Keypoint& k = pair.map.views.at(o.keyframe).features.keypoints[o.feature];
    EXPECT_GE((k.Position() - Eigen::Vector2d(320, 240)).norm(),
              10 * pair.scene.scales.scale(k.octave));
    ASSERT_GE(pair.TruthOf(id), 0);
    EXPECT_LT(pair.Chi2(id), 25);
  }
}

TEST(PointCreator, WrongFeaturesMakeFewPoints) {
  Pair pair(6, {.descriptor_bits = 20, .outlier_share = 0.2, .clutter = 300}, Sideways());
  const std::vector<PointId> created = pair.Create();
  int wrong = 0;
  for (const PointId id : created) wrong += pair.TruthOf(id) < 0;
  EXPECT_GT(created.size(), 100u);
  // What is displaced has to lie within 2 sigma of a line, of 60 px to either side: one in twenty;
  // the two displacements are independent.
  EXPECT_LT(wrong, 0.06 * static_cast<double>(created.size()));
}

TEST(PointCreator, OctavesMustAgreeWithDistances) {
  Pair pair(7, {.max_octave = 0}, Sideways());  // octaves 0 to 3
  for (Keypoint& k : pair.map.FeaturesOf(KeyframeId(0)).keypoints) k.octave = 7;
  EXPECT_TRUE(pair.Create({.max_scale_mismatch = 1.5}).empty());  // 1.2^3 > 1.5
  EXPECT_GT(pair.Create({.max_scale_mismatch = 5}).size(), 50u);
}

TEST(PointCreator, FeaturesThatHavePointsAreLeftAlone) {
  Pair pair(8, {}, Sideways());
  const auto before = pair.map.map.Find(KeyframeId(1))->points;
  pair.Create();
  const auto& after = pair.map.map.Find(KeyframeId(1))->points;
  for (size_t i = 0; i < before.size(); ++i) {
    if (before[i].IsValid()) {
      EXPECT_EQ(before[i], after[i]);
    }
  }
  EXPECT_TRUE(pair.Create().empty()) << "everything that can be a point is one";
}

TEST(PointCreator, AsksTheBestNeighboursOnly) {
  const auto build = [](int neighbours) {
    Pair pair(9, {}, PoseAt({0.5, 0, 0}));
    // Shares fewer points with the new keyframe than the other two do.
    const KeyframeId side = pair.map.AddKeyframe(pair.scene.Look(PoseAt({-1.2, 0, 0})));
    const KeyframeId last = pair.map.AddKeyframe(pair.scene.Look(PoseAt({0.25, 0.4, 0})));
    for (int p = kKnown; p < kKnown + 40; ++p) pair.map.AddPoint(p, {side, last});
    for (int p = kKnown + 40; p < kKnown + 160; ++p) pair.map.AddPoint(p, {KeyframeId(1), last});
    std::set<KeyframeId> used;
    for (const PointId id : pair.Create({.neighbours = neighbours})) {
      used.insert(pair.map.map.Find(id)->observations.front().keyframe);
    }
    return used;
  };
  EXPECT_EQ(build(1), (std::set<KeyframeId>{KeyframeId(1)}));
  EXPECT_EQ(build(20), (std::set<KeyframeId>{KeyframeId(1), KeyframeId(2)}));
}

TEST(PointCreator, SameInputSameBytes) {
  const auto run = [] {
    Pair pair(10, {.outlier_share = 0.1, .clutter = 100}, Sideways());
    pair.Create();
    return BytesOf(pair.map.map.TakeDeltas(KeyframeId(1), {}));
  };
  const std::string once = run();
  EXPECT_GT(once.size(), 10000u);
  EXPECT_EQ(once, run());
}

}  // namespace
}  // namespace vpslam
