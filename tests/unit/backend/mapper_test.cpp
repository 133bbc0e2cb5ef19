// The backend from end to end: keyframes as an ideal frontend would propose them, the map against
// the truth.
#include "backend/mapper.h"

#include <gtest/gtest.h>

#include "core/geometry/sim3.h"
#include "tests/unit/backend/ideal_frontend.h"

namespace vpslam {
namespace {

constexpr int kViews = 24;
std::unique_ptr<IdealFrontend> Walk(uint64_t seed, const SyntheticOptions& options) {
  auto frontend = std::make_unique<IdealFrontend>(seed, options);
  frontend->Start(OnTheWay(0), OnTheWay(2));
  for (int i = 3; i < kViews; ++i) frontend->Add(OnTheWay(i));
  return frontend;
}

struct Errors {
  double scale = 0;
  double keyframes = 0;     ///< RMSE of centres, after Sim(3) alignment
  double median_point = 0;  ///< of points, in the same frame, as a share of their depth
  double wrong_points = 0;  ///< share with observations of different things
};

/// Aligned by the centres and by where the cameras look: centres on a line leave a turn about it
/// open, and depths of points are too noisy.
Errors Compare(const IdealFrontend& f) {
  std::vector<SE3> estimate, truth;
  for (const auto& [id, view] : f.views) {
    SE3 pose;
    if (!f.replica.CamFromWorld(id, &pose)) continue;
    estimate.push_back(pose);
    truth.push_back(view.cam_from_world);
  }
  const auto length = [](const std::vector<SE3>& poses) {
    return (poses.back().Center() - poses.front().Center()).norm();
  };
  const double scale = length(truth) / length(estimate);
  std::vector<Eigen::Vector3d> a, b;
  for (size_t i = 0; i < truth.size(); ++i) {
    for (const Eigen::Vector3d& x : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(3, 0, 5),
                                     Eigen::Vector3d(0, 3, 5), Eigen::Vector3d(-3, -3, 5)}) {
      a.push_back(estimate[i].Inverse() * Eigen::Vector3d(x / scale));
      b.push_back(truth[i].Inverse() * x);
    }
  }
  const Sim3 truth_from_map = *AlignPoints(a, b);
  Errors errors;
  errors.scale = scale;
  for (size_t i = 0; i < truth.size(); ++i) {
    errors.keyframes += (truth_from_map * estimate[i].Center() - truth[i].Center()).squaredNorm();
  }
  errors.keyframes = std::sqrt(errors.keyframes / static_cast<double>(truth.size()));
  std::vector<double> points;
  int wrong = 0;
  for (int i = 0; i < EndOf(f.replica.points()); ++i) {
    const MapPoint* point = f.replica.Find(PointId(i));
    if (!point) continue;
    const int p = f.TruthOf(*point);
    const bool right = p >= 0 && std::all_of(point->observations.begin(), point->observations.end(),
                                             [&](const Observation& o) {
                                               return f.views.at(o.keyframe).point[o.feature] == p;
                                             });
    wrong += !right;
    if (!right) continue;
    const Eigen::Vector3d& x = f.scene.points[p].position;
    points.push_back((truth_from_map * point->position - x).norm() / x.z());
  }
  std::sort(points.begin(), points.end());
  errors.median_point = points[points.size() / 2];
  errors.wrong_points = wrong / static_cast<double>(wrong + points.size());
  return errors;
}

TEST(Mapper, AWalkAgainstTheTruth) {
  for (const auto shape : {SyntheticShape::kVolume, SyntheticShape::kFrontoParallel}) {
    const auto f = Walk(1, {.shape = shape,
                            .num_points = 1200,
                            .length = 14,
                            .outlier_share = 0.05,
                            .clutter = 50,
                            .detected_share = 0.9});
    const Errors errors = Compare(*f);
    // Half a percent of the way. A corner that is followed for one unit has its depth to
    // 2 %: 1.7 px of 100. The first two views set the scale, which drifts.
    EXPECT_LT(errors.keyframes, 0.03);
    EXPECT_LT(errors.median_point, 0.02);
    EXPECT_NEAR(errors.scale, 1, 0.05);
    EXPECT_LT(errors.wrong_points, 0.03);
    EXPECT_GT(f->replica.NumPoints(MapId(0)), 600);
    // No corner twice.
    std::map<int, int> copies;
    int twice = 0;
    for (int i = 0; i < EndOf(f->replica.points()); ++i) {
      const MapPoint* point = f->replica.Find(PointId(i));
      if (point) twice += ++copies[f->TruthOf(*point)] == 2;
    }
    EXPECT_LT(twice, 0.03 * f->replica.NumPoints(MapId(0)));
  }
}

TEST(Mapper, SameInputSameBytesAndTheReplicaHasItAll) {
  const SyntheticOptions options{.num_points = 500, .length = 10, .clutter = 30};
  const auto a = Walk(2, options), b = Walk(2, options);
  EXPECT_GT(a->bytes.size(), 100000u);
  EXPECT_EQ(a->bytes, b->bytes);
  EXPECT_EQ(BytesOf(a->mapper.Snapshot()), BytesOf(a->replica.Snapshot()));
}

TEST(Mapper, StandingStillCullsWhatTellsNothingNew) {
  IdealFrontend f(3, {});
  f.Start(PoseAt({0, 0, 0}), PoseAt({0.5, 0, 0}));
  for (int i = 0; i < 8; ++i) f.Add(PoseAt({0.5 + 0.01 * i, 0.01 * (i % 2), 0}));
  EXPECT_LE(f.replica.NumKeyframes(MapId(0)), 6);
  EXPECT_GE(f.replica.NumKeyframes(MapId(0)), 3);
  EXPECT_LT(Compare(f).keyframes, 0.02);  // culled ones count, too
}

TEST(Mapper, ADiscardedMapLeavesNothing) {
  IdealFrontend f(4, {});
  f.Start(OnTheWay(0), OnTheWay(2));
  f.Add(OnTheWay(3));
  EXPECT_GT(f.replica.NumPoints(MapId(0)), 100);
  f.Start(OnTheWay(4), OnTheWay(6), MapId(0));
  f.Add(OnTheWay(7));
  EXPECT_EQ(f.replica.NumPoints(MapId(0)), 0);
  EXPECT_EQ(f.replica.NumKeyframes(MapId(0)), 0);
  EXPECT_EQ(f.replica.NumKeyframes(MapId(1)), 3);
  EXPECT_GT(f.replica.NumPoints(MapId(1)), 100);
  for (int i = 0; i < EndOf(f.replica.points()); ++i) {
    const MapPoint* point = f.replica.Find(PointId(i));
    if (point) {
      EXPECT_EQ(point->map, MapId(1));
    }
  }
}

/// A view of the scene that starts map 0.
KeyframeProposal Look(KeyframeId id, KeyframeRole role, SyntheticScene* scene) {
  KeyframeProposal proposal;
  proposal.id = id;
  proposal.map = MapId(0);
  proposal.role = role;
  proposal.features = scene->Look(PoseAt({0, 0, 0})).features;
  return proposal;
}

TEST(Mapper, FirstAndSecondBelongTogether) {
  SyntheticScene scene(5);
  Mapper mapper(scene.camera, {});
  const KeyframeProposal second = Look(KeyframeId(1), KeyframeRole::kMapSecond, &scene);
  const auto parts = mapper.Process(second);
  ASSERT_EQ(parts.size(), 1u) << "an answer, which says that nothing was done";
  EXPECT_EQ(parts[0].answers, KeyframeId(1));
  EXPECT_TRUE(parts[0].keyframes.empty());
}

TEST(Mapper, LevelsThatThePyramidDoesNotHaveAreAnError) {
  SyntheticScene scene(7);
  Mapper mapper(scene.camera, {});
  KeyframeProposal first = Look(KeyframeId(0), KeyframeRole::kMapFirst, &scene);
  first.features.keypoints[3].octave = MapperOptions().orb.num_levels;
  EXPECT_THROW(mapper.Process(first), std::runtime_error);
}

TEST(Mapper, PointsThatWereFusedOrErasedSinceAreTakenForWhatTheyAre) {
  IdealFrontend f(6, {});
  f.Start(OnTheWay(0), OnTheWay(2));
  f.Add(OnTheWay(3));
  // A proposal from a frontend that has not heard of the latest: points unknown, one twice.
  KeyframeProposal late;
  late.id = KeyframeId(3);
  late.map = MapId(0);
  late.reference = KeyframeId(2);
  const SyntheticView view = f.scene.Look(OnTheWay(4));
  late.features = view.features;
  late.cam_from_world = OnTheWay(4) * OnTheWay(0).Inverse();
  late.points.assign(view.features.size(), PointId(1 << 20));
  const PointId known = f.replica.Find(KeyframeId(2))->points[0].IsValid()
                            ? f.replica.Find(KeyframeId(2))->points[0]
                            : PointId(0);
  late.points[0] = late.points[1] = known;
  late.sightings = {{PointId(1 << 20), 5, 0}, {PointId(), 5, 0}};
  f.views[late.id] = view;
  f.Send(late);
  std::map<PointId, int> count;
  for (const PointId id : f.replica.Find(late.id)->points) {
    if (id.IsValid()) {
      EXPECT_EQ(++count[id], 1);
    }
  }
}

}  // namespace
}  // namespace vpslam
