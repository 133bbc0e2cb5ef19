// The backend from end to end: keyframes as an ideal frontend would propose them, the map against
// the truth.
#include "backend/mapper.h"

#include <gtest/gtest.h>

#include "core/estimation/pose_optimizer.h"
#include "core/geometry/sim3.h"
#include "tests/unit/synthetic_scene.h"

namespace vpslam {
namespace {

/// Knows which feature shows what, measures poses in its replica as tracking does, and makes
/// keyframes of all views.
class IdealFrontend {
 public:
  IdealFrontend(uint64_t seed, const SyntheticOptions& options)
      : scene(seed, options), mapper(scene.camera, MapperOptions()) {}

  SyntheticScene scene;
  Mapper mapper;
  Map replica;
  std::map<KeyframeId, SyntheticView> views;
  std::string bytes;  ///< of all deltas
  std::vector<MapDelta> last_answer;

  void Send(const KeyframeProposal& proposal) {
    last_answer = mapper.Process(proposal);
    bytes += BytesOf(last_answer);
    for (const MapDelta& delta : last_answer) ASSERT_TRUE(replica.Apply(delta));
    ASSERT_EQ(last_answer.back().answers, proposal.id);
    ASSERT_EQ(replica.version(), mapper.version());
  }
  void Start(const SE3& a, const SE3& b, MapId discarded = MapId()) {
    map_ = MapId(map_.value + 1);
    world_ = a;
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
  void Add(const SE3& truth) {
    KeyframeProposal proposal = Propose(scene.Look(truth));
    const SyntheticView& view = views.at(proposal.id);
    std::map<int, PointId> known;
    for (int32_t i = 0; i < replica.point_end(); ++i) {
      const MapPoint* point = replica.Find(PointId(i));
      if (point && point->map == map_ && TruthOf(*point) >= 0) known[TruthOf(*point)] = point->id;
    }
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
    const PoseEstimate pose = OptimizePose(
        scene.camera, measurements, scene.Disturbed(truth * world_.Inverse(), 0.02, 0.005), {});
    proposal.cam_from_world = pose.cam_from_world;
    for (size_t i = 0; i < features.size(); ++i) {
      if (!pose.inliers[i]) proposal.points[features[i]] = PointId();
    }
    proposal.reference = KeyframeId(proposal.id.value - 1);
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
    views[proposal.id] = view;
    return proposal;
  }

  MapId map_;
  SE3 world_;  ///< of the map, from that of the scene
  int32_t next_ = 0;
};

constexpr int kViews = 24;
SE3 OnTheWay(int i) {
  return PoseAt({0.25 * i, 0.15 * std::sin(0.7 * i), 0.1 * std::cos(0.5 * i)},
                {0.02 * std::sin(i), 0.1 * std::sin(0.4 * i), 0.03 * std::cos(i)});
}

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
  for (int32_t i = 0; i < f.replica.point_end(); ++i) {
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
    for (int32_t i = 0; i < f->replica.point_end(); ++i) {
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
  for (int32_t i = 0; i < f.replica.point_end(); ++i) {
    const MapPoint* point = f.replica.Find(PointId(i));
    if (point) {
      EXPECT_EQ(point->map, MapId(1));
    }
  }
}

TEST(Mapper, FirstAndSecondBelongTogether) {
  SyntheticScene scene(5);
  Mapper mapper(scene.camera, {});
  KeyframeProposal second;
  second.id = KeyframeId(1);
  second.map = MapId(0);
  second.role = KeyframeRole::kMapSecond;
  second.features = scene.Look(PoseAt({0, 0, 0})).features;
  const auto parts = mapper.Process(second);
  ASSERT_EQ(parts.size(), 1u) << "an answer, which says that nothing was done";
  EXPECT_EQ(parts[0].answers, KeyframeId(1));
  EXPECT_TRUE(parts[0].keyframes.empty());
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
