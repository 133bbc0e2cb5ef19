#include "backend/point_fuser.h"

#include <gtest/gtest.h>

#include "tests/unit/synthetic_scene.h"

namespace vpslam {
namespace {

constexpr int kShared = 120;  // points of the scene that all keyframes have
const KeyframeId kA(0), kB(1), kC(2), kNew(3);

/// Three keyframes and a new one that share points; the rest is for the tests.
struct Fixture {
  explicit Fixture(uint64_t seed, const SyntheticOptions& options = {})
      : scene(seed, options), map(scene) {
    map.AddKeyframe(scene.Look(PoseAt({-0.4, 0, 0})));
    map.AddKeyframe(scene.Look(PoseAt({0, 0.1, 0})));
    map.AddKeyframe(scene.Look(PoseAt({0.4, 0, 0})));
    map.AddKeyframe(scene.Look(PoseAt({0.8, 0, 0})));
    map.AddPoints(0, kShared);
    map.map.TakeDeltas(KeyframeId(), {});
  }
  void Fuse(const PointFuserOptions& options = {}) { FusePoints(map.Context(), kNew, options); }
  /// Points of the scene, beyond those shared, that all of the keyframes show where they should.
  std::vector<int> SeenByAll() const {
    std::vector<int> result;
    for (int p = kShared; p < static_cast<int>(scene.points.size()); ++p) {
      bool seen = true;
      for (const auto& [id, view] : map.views) {
        const int f = view.FeatureOf(p);
        seen = seen && f >= 0 && ErrorSigmas(view, f, p) < 2.3;
      }
      if (seen) result.push_back(p);
    }
    return result;
  }
  double ErrorSigmas(const SyntheticView& view, int feature, int p) const {
    const Keypoint& k = view.features.keypoints[feature];
    return (scene.camera.Project(view.cam_from_world * scene.points[p].position) - k.Position())
               .norm() /
           scene.scales.sigma_px(k.octave);
  }
  size_t NumObservations(PointId id) const {
    const MapPoint* point = map.map.Find(id);
    return point ? point->observations.size() : 0;
  }

  SyntheticScene scene;
  SyntheticMap map;
};

TEST(PointFuser, JoinsDuplicatesAndTheBetterKnownStays) {
  Fixture f(1);
  const std::vector<int> points = f.SeenByAll();
  ASSERT_GT(points.size(), 100u);
  // Twice in the map: seen by the new keyframe and one neighbour, and by both of the others.
  int joined = 0;
  for (size_t i = 0; i < points.size(); ++i) {
    f.map.AddPoint(points[i], {kA, kB});
    f.map.AddPoint(points[i], {kC, kNew});
  }
  const int begin = EndOf(f.map.map.points()) - 2 * static_cast<int>(points.size());
  const int before = f.map.map.NumPoints(MapId(0));
  f.Fuse();
  for (size_t i = 0; i < points.size(); ++i) {
    const PointId first(begin + 2 * static_cast<int>(i)), second(first.value + 1);
    const PointId alive = f.map.map.Resolve(first);
    if (alive != f.map.map.Resolve(second)) continue;
    ++joined;
    EXPECT_EQ(f.NumObservations(alive), 4u);
    for (const Observation& o : f.map.map.Find(alive)->observations) {
      EXPECT_EQ(f.map.views.at(o.keyframe).point[o.feature], points[i]);
    }
  }
  EXPECT_GT(joined, 0.97 * static_cast<double>(points.size()));
  EXPECT_EQ(f.map.map.NumPoints(MapId(0)), before - joined);
}

TEST(PointFuser, TheBetterKnownPointStays) {
  Fixture f(2);
  const std::vector<int> points = f.SeenByAll();
  const PointId many = f.map.AddPoint(points[0], {kA, kB, kC});
  const SyntheticView& view = f.map.views.at(kNew);
  // Known to the new keyframe and to nobody else.
  const PointId few = f.map.map.CreatePoint(MapId(0), kNew, f.scene.points[points[0]].position);
  f.map.map.Observe(kNew, view.FeatureOf(points[0]), few);
  f.map.map.SetDescriptor(few, f.scene.points[points[0]].descriptor);
  f.map.map.SetView(few, f.map.map.Find(many)->normal, f.map.map.Find(many)->max_distance);
  f.Fuse();
  EXPECT_EQ(f.map.map.Find(few), nullptr);
  EXPECT_EQ(f.map.map.Resolve(few), many);
  EXPECT_EQ(f.NumObservations(many), 4u);
}

TEST(PointFuser, FreeFeaturesGainObservations) {
  Fixture f(3);
  const std::vector<int> points = f.SeenByAll();
  const PointId of_neighbours = f.map.AddPoint(points[0], {kA, kB});
  const PointId of_new = f.map.AddPoint(points[1], {kC, kNew});
  f.Fuse();
  EXPECT_EQ(f.NumObservations(of_neighbours), 3u);
  EXPECT_EQ(f.NumObservations(of_new), 4u);
  // The observations are the right ones, and the view was derived anew from them.
  for (const Observation& o : f.map.map.Find(of_new)->observations) {
    EXPECT_EQ(f.map.views.at(o.keyframe).point[o.feature], points[1]);
  }
  const Eigen::Vector3d to_a = f.map.map.Find(kA)->Center() - f.map.map.Find(of_new)->position;
  EXPECT_GT(f.map.map.Find(of_new)->normal.dot(to_a.normalized()), 0.98);
}

TEST(PointFuser, PlaceAndLooksMustBothAgree) {
  Fixture f(4, {.noise_sigmas = 0});
  const std::vector<int> points = f.SeenByAll();
  ASSERT_GT(points.size(), 100u);
  // Where another corner is, but with looks of its own.
  const PointId other_looks = f.map.AddPoint(points[0], {kA, kB});
  f.map.map.SetDescriptor(other_looks, f.scene.points[points[1]].descriptor);
  // Like a corner, but four sigma away from it: within the window, beyond the gate.
  const double off = 4 * f.scene.scales.sigma_px(0) / f.scene.camera.fx;
  std::vector<PointId> elsewhere;
  for (size_t i = 2; i < 40; ++i) {
    const Eigen::Vector3d x = f.scene.points[points[i]].position;
    const auto& view = f.map.views.at(kNew);
    const int octave = view.features.keypoints[view.FeatureOf(points[i])].octave;
    const Eigen::Vector3d shift(0, off * f.scene.scales.scale(octave) * x.z(), 0);
    elsewhere.push_back(f.map.AddPoint(points[i], x + shift, {kA, kB}));
  }
  f.Fuse();
  EXPECT_EQ(f.NumObservations(other_looks), 2u);
  for (const PointId id : elsewhere) EXPECT_EQ(f.NumObservations(id), 2u);
}

TEST(PointFuser, NothingIsFoundBehindOrTooObliquely) {
  Fixture f(5, {.noise_sigmas = 0});
  const std::vector<int> points = f.SeenByAll();
  const PointId oblique = f.map.AddPoint(points[0], {kA, kB});
  f.map.map.SetView(oblique, Eigen::Vector3d(1, 0, 0), f.map.map.Find(oblique)->max_distance);
  const PointId too_far = f.map.AddPoint(points[1], {kA, kB});
  f.map.map.SetView(too_far, f.map.map.Find(too_far)->normal, 1.0);
  const PointId mirrored = f.map.AddPoint(points[2], -f.scene.points[points[2]].position, {kA, kB});
  f.Fuse();
  for (const PointId id : {oblique, too_far, mirrored}) EXPECT_EQ(f.NumObservations(id), 2u);
}

TEST(PointFuser, NeighboursOfNeighboursAreAskedAsFarAsSet) {
  const auto observers = [](int second_neighbours) {
    Fixture f(6);
    // Shares points with kA, but none with the new keyframe.
    const KeyframeId far = f.map.AddKeyframe(f.scene.Look(PoseAt({-0.6, 0, 0})));
    const std::vector<int> points = f.SeenByAll();
    for (size_t i = 1; i < 30; ++i) f.map.AddPoint(points[i], {kA, far});
    // The new keyframe shows these as well, and would join: take the features away from it.
    for (size_t i = 1; i < 30; ++i) {
      Features& features = f.map.FeaturesOf(kNew);
      features.descriptors[f.map.views.at(kNew).FeatureOf(points[i])] = Descriptor{};
    }
    const PointId point = f.map.AddPoint(points[0], {kC, kNew});
    f.Fuse({.neighbours = 3, .second_neighbours = second_neighbours});
    std::set<KeyframeId> result;
    for (const Observation& o : f.map.map.Find(point)->observations) result.insert(o.keyframe);
    return result;
  };
  EXPECT_EQ(observers(0).count(KeyframeId(4)), 0u);
  EXPECT_EQ(observers(5).count(KeyframeId(4)), 1u);
}

TEST(PointFuser, OnceIsEnough) {
  Fixture f(7, {.outlier_share = 0.1, .clutter = 100});
  for (const int p : f.SeenByAll()) {
    f.map.AddPoint(p, {kA, kB});
    f.map.AddPoint(p, {kC, kNew});
  }
  f.Fuse();
  EXPECT_GT(BytesOf(f.map.map.TakeDeltas(kNew, {})).size(), 10000u);
  f.Fuse();
  for (const MapDelta& delta : f.map.map.TakeDeltas(kNew, {})) {
    EXPECT_TRUE(delta.tombstones.empty());
    EXPECT_TRUE(delta.keyframes.empty());
  }
}

TEST(PointFuser, SameInputSameBytes) {
  const auto run = [] {
    Fixture f(8, {.outlier_share = 0.1, .clutter = 100});
    for (const int p : f.SeenByAll()) {
      f.map.AddPoint(p, {kA, kB});
      f.map.AddPoint(p, {kC, kNew});
    }
    f.Fuse();
    return BytesOf(f.map.map.TakeDeltas(kNew, {}));
  };
  EXPECT_EQ(run(), run());
}

}  // namespace
}  // namespace vpslam
