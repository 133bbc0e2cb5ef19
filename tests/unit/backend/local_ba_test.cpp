#include "backend/local_ba.h"

#include <memory>

#include <gtest/gtest.h>

#include "core/geometry/sim3.h"
#include "tests/unit/synthetic_scene.h"

namespace vpslam {
namespace {

/// As many iterations as it takes.
const LocalBaOptions kThorough{
    .min_fixed_keyframes = 1, .max_iterations = 50, .function_tolerance = 1e-10};

const ManhattanFrames kNoAxes{ManhattanOptions()};

/// Keyframes side by side at their true places, and all points that two of them show.
struct Fixture {
  explicit Fixture(int num_keyframes, uint64_t seed, const SyntheticOptions& options = {})
      : scene(seed, options), map(scene) {
    for (int i = 0; i < num_keyframes; ++i) {
      map.AddKeyframe(scene.Look(PoseAt({0.3 * i, 0.1 * (i % 3), 0.05 * i}, {0, -0.04 * i, 0})));
    }
    map.AddPoints(0, static_cast<int>(scene.points.size()));
  }
  KeyframeId last() const { return KeyframeId(KeyframeEnd(map.map) - 1); }

  void DisturbPoses(int begin, double sigma, double sigma_rad) {
    for (int i = begin; i <= last().value; ++i) {
      const SE3& truth = map.views.at(KeyframeId(i)).cam_from_world;
      map.map.SetPose(KeyframeId(i), scene.Disturbed(truth, sigma, sigma_rad));
    }
  }
  void DisturbPoints(double sigma) {
    for (const auto& [id, p] : map.truth) {
      map.map.SetPosition(id, scene.points[p].position + scene.NormalVector(sigma));
    }
  }
  /// Another unit of length, another world.
  void Transform(const Sim3& b_from_a) {
    for (int i = 0; i <= last().value; ++i) {
      const KeyframeId k(i);
      map.map.SetPose(k, TransformWorld(map.map.Find(k)->cam_from_world, b_from_a));
    }
    for (const auto& [id, p] : map.truth) {
      map.map.SetPosition(id, b_from_a * map.map.Find(id)->position);
    }
  }
  BaSummary Adjust(const LocalBaOptions& options = kThorough,
                   const ManhattanFrames& axes = kNoAxes) {
    return AdjustLocally(map.Context(), last(), axes, options, options.max_iterations);
  }
  std::vector<Eigen::Vector3d> Centers() const {
    std::vector<Eigen::Vector3d> centers;
    for (int i = 0; i <= last().value; ++i) {
      centers.push_back(map.map.Find(KeyframeId(i))->Center());
    }
    return centers;
  }
  std::vector<Eigen::Vector3d> TrueCenters() const {
    std::vector<Eigen::Vector3d> centers;
    for (const auto& [id, view] : map.views) centers.push_back(view.cam_from_world.Center());
    return centers;
  }

  SyntheticScene scene;
  SyntheticMap map;
};

double Rmse(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}
double RmseAligned(const std::vector<Eigen::Vector3d>& a, std::vector<Eigen::Vector3d> b) {
  const auto a_from_b = AlignPoints(b, a);
  for (Eigen::Vector3d& x : b) x = *a_from_b * x;
  return Rmse(a, b);
}

TEST(LocalBa, WhatIsLeftIsTheNoise) {
  for (const auto shape :
       {SyntheticShape::kVolume, SyntheticShape::kSlantedPlane, SyntheticShape::kFrontoParallel}) {
    Fixture f(6, 1, {.shape = shape});
    f.DisturbPoses(1, 0.02, 0.005);
    f.DisturbPoints(0.03);
    const BaSummary summary = f.Adjust();
    EXPECT_EQ(summary.keyframes, 5);
    EXPECT_EQ(summary.fixed_keyframes, 1);
    EXPECT_EQ(summary.points, static_cast<int>(f.map.truth.size()));
    // Measurements less what they determine; one gauge remains, the scale.
    const double freedom = 2.0 * summary.observations - 6 * 5 - 3.0 * summary.points + 1;
    EXPECT_NEAR(2 * summary.final_cost, freedom, 4 * std::sqrt(2 * freedom));
    EXPECT_GT(summary.initial_cost, 5 * summary.final_cost);
    // A pixel is 0.01 at a depth of 5, and hundreds of points average it; but shifts and turns of a
    // camera look alike.
    EXPECT_LT(RmseAligned(f.TrueCenters(), f.Centers()), 0.02);
  }
}

TEST(LocalBa, VanishingPointsTurnAKeyframeTheirWay) {
  Fixture f(8, 7);
  const KeyframeId odd(1);  // not among the latest, whose agreement gives birth to the frame
  const Eigen::Vector3d turn_rad(0.02, -0.03, 0.015);
  ManhattanFrames axes({.min_sigma_deg = 1e-3});
  for (const auto& [id, view] : f.map.views) {
    LineSet lines;
    lines.manhattan = ManhattanState::kThree;
    lines.vanishing_points.resize(3, {.support = 10});
    lines.cam_from_manhattan = view.cam_from_world.rotation;
    if (id == odd) lines.cam_from_manhattan = ExpSo3(turn_rad) * lines.cam_from_manhattan;
    lines.covariance_rad2 = 1e-10 * Eigen::Matrix3d::Identity();
    axes.Add(id, lines);
  }
  axes.Update(f.map.map_id, &f.map.map);
  const auto turned = [&] {
    return LogSo3(f.map.map.Find(odd)->cam_from_world.rotation *
                  f.map.views.at(odd).cam_from_world.rotation.conjugate());
  };
  f.Adjust();
  EXPECT_LT(turned().norm(), 0.2 * turn_rad.norm());
  f.Adjust(kThorough, axes);
  // The frame itself is the mean of eight, one of which is turned.
  EXPECT_LT((turned() - turn_rad).norm(), 0.3 * turn_rad.norm());
}

TEST(LocalBa, TheFirstKeyframeHoldsTheGauge) {
  for (const double scale : {0.2, 1.0, 5.0}) {
    Fixture f(2, 2);
    f.DisturbPoses(1, 0.02, 0.005);
    f.DisturbPoints(0.02);
    f.Transform({ExpSo3({0.3, 0.2, 0.1}), {1, 2, 3}, scale});
    const SE3 before = f.map.map.Find(KeyframeId(0))->cam_from_world;
    const double baseline = (f.Centers()[1] - f.Centers()[0]).norm();
    f.Adjust();
    const SE3& after = f.map.map.Find(KeyframeId(0))->cam_from_world;
    EXPECT_EQ(before.translation, after.translation);
    EXPECT_EQ(before.rotation.coeffs(), after.rotation.coeffs());
    // The scale is free, but nothing pulls at it: the structure's stays within its disturbance.
    std::vector<Eigen::Vector3d> truth, estimate;
    for (const auto& [id, p] : f.map.truth) {
      if (!f.map.map.Find(id)) continue;
      truth.push_back(f.scene.points[p].position);
      estimate.push_back(f.map.map.Find(id)->position);
    }
    EXPECT_NEAR(AlignPoints(truth, estimate)->scale / scale, 1, 0.1);
    EXPECT_NEAR((f.Centers()[1] - f.Centers()[0]).norm() / baseline, 1, 0.1);
  }
}

TEST(LocalBa, TheWorldDoesNotMatter) {
  const auto run = [](const Sim3& world) {
    Fixture f(5, 3);
    f.DisturbPoses(1, 0.02, 0.005);
    f.DisturbPoints(0.02);
    f.Transform(world);
    f.Adjust();
    return f.Centers();
  };
  const auto a = run({}), b = run({ExpSo3({1, 2, 0.5}), {-3, 20, 5}, 0.1});
  EXPECT_LT(RmseAligned(a, b), 1e-4);
}

TEST(LocalBa, MovesTheWindowAlone) {
  Fixture f(9, 4);
  f.DisturbPoses(0, 0.004, 0.001);
  const auto order = f.map.map.Covisible(f.last(), 1);
  const std::set<KeyframeId> expected{f.last(), order[0].first, order[1].first};
  const Map before = f.map.map;
  LocalBaOptions options = kThorough;
  options.max_keyframes = 3;
  options.max_fixed_keyframes = 4;
  options.max_growth = 1;
  const BaSummary summary = f.Adjust(options);
  EXPECT_EQ(summary.keyframes, 3);
  EXPECT_EQ(summary.fixed_keyframes, 4);
  for (int i = 0; i < 9; ++i) {
    const KeyframeId k(i);
    const bool moved =
        f.map.map.Find(k)->cam_from_world.translation != before.Find(k)->cam_from_world.translation;
    EXPECT_EQ(moved, expected.contains(k)) << i;
  }
  int points = 0;
  for (const auto& [id, p] : f.map.truth) {
    bool in_window = false;
    for (const Observation& o : before.Find(id)->observations) {
      in_window = in_window || expected.contains(o.keyframe);
    }
    points += in_window;
    if (!in_window) {
      EXPECT_EQ(f.map.map.Find(id)->position, before.Find(id)->position);
    }
  }
  EXPECT_EQ(summary.points, points);
  EXPECT_LT(points, static_cast<int>(f.map.truth.size()));
}

TEST(LocalBa, WhoSharesLittleIsMeasuredFromButNotMoved) {
  Fixture f(5, 5);
  int most = 0, least = 1 << 20;
  for (const auto& [k, shared] : f.map.map.Covisible(f.last(), 1)) {
    most = std::max(most, shared);
    least = std::min(least, shared);
  }
  ASSERT_LT(least, most);
  LocalBaOptions options = kThorough;
  options.min_shared_points = least + 1;
  const BaSummary summary = f.Adjust(options);
  EXPECT_EQ(summary.keyframes, 4);
  EXPECT_EQ(summary.fixed_keyframes, 1);
}

TEST(LocalBa, TrueNeighboursGiveATruePose) {
  Fixture f(7, 6);
  f.DisturbPoses(6, 0.05, 0.01);
  LocalBaOptions options = kThorough;
  options.max_keyframes = 1;
  f.Adjust(options);
  const KeyframeId k = f.last();
  const Vector6d error =
      LocalCoordinates(f.map.views.at(k).cam_from_world, f.map.map.Find(k)->cam_from_world);
  // Each of n > 200 points says where the camera is, and how it is turned, to 5 x 1.5 px / 520 and
  // 1.5 px / 520; shifts and turns look alike, which takes a factor of 3. Four sigma.
  const double sigma_rad = 3 * 1.5 / 520 / std::sqrt(200.0);
  EXPECT_LT(error.head<3>().norm(), 4 * 5 * sigma_rad);
  EXPECT_LT(error.tail<3>().norm(), 4 * sigma_rad);
}

TEST(LocalBa, OutliersAreTakenOut) {
  Fixture f(6, 7);
  std::set<std::pair<KeyframeId, PointId>> wrong;
  int total = 0, of_two = 0;
  for (const auto& [id, p] : f.map.truth) {
    const auto& observations = f.map.map.Find(id)->observations;
    total += static_cast<int>(observations.size());
    if (id.value % 10) continue;
    const Observation& o = observations.back();
    Keypoint& k = f.map.FeaturesOf(o.keyframe).keypoints[o.feature];
    k.x_px += 25 * static_cast<float>(f.scene.scales.scale(k.octave));
    wrong.insert({o.keyframe, id});
    of_two += observations.size() == 2;
  }
  ASSERT_GT(wrong.size(), 30u);
  f.Adjust();
  int left = 0, wrong_left = 0, erased = 0;
  for (const auto& [id, p] : f.map.truth) {
    const MapPoint* point = f.map.map.Find(id);
    erased += !point;
    if (!point) continue;
    EXPECT_GE(point->observations.size(), 2u);
    left += static_cast<int>(point->observations.size());
    for (const Observation& o : point->observations) wrong_left += wrong.contains({o.keyframe, id});
  }
  // Of two observations neither is known to be wrong, if the point can do justice to both.
  EXPECT_LE(wrong_left, of_two);
  // One good measurement in twenty fails the gate, and takes the last of a pair with it.
  EXPECT_GT(left, 0.85 * total);
  EXPECT_GT(erased, 0);
}

TEST(LocalBa, WithTwoKeyframesHeldTheScaleIs) {
  Fixture f(6, 1);
  LocalBaOptions options = kThorough;
  options.min_fixed_keyframes = 2;
  f.DisturbPoses(2, 0.02, 0.005);
  f.DisturbPoints(0.03);
  const BaSummary summary = f.Adjust(options);
  EXPECT_EQ(summary.fixed_keyframes, 2);
  // Measurements less what they determine; no gauge remains.
  const double freedom = 2.0 * summary.observations - 6 * 4 - 3.0 * summary.points;
  EXPECT_NEAR(2 * summary.final_cost, freedom, 4 * std::sqrt(2 * freedom));
  EXPECT_LT(Rmse(f.TrueCenters(), f.Centers()), 0.02);
}

TEST(LocalBa, WhatFailsChangesNothing) {
  Fixture f(6, 1);
  f.DisturbPoses(1, 0.02, 0.005);
  const PointId broken = f.map.truth.begin()->first;
  f.map.map.SetPosition(broken, Eigen::Vector3d::Constant(std::nan("")));
  const std::vector<Eigen::Vector3d> before = f.Centers();
  const size_t observations = f.map.map.Find(broken)->observations.size();
  const BaSummary summary = f.Adjust();
  EXPECT_FALSE(summary.usable);
  EXPECT_EQ(f.Centers(), before);
  EXPECT_EQ(f.map.map.Find(broken)->observations.size(), observations);
}

TEST(LocalBa, OnceMoreWithoutTheOutliersIsBetter) {
  double error[2] = {0, 0};
  for (const int again : {0, 1}) {
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      Fixture f(6, seed);
      for (const auto& [id, p] : f.map.truth) {
        if (id.value % 5) continue;
        const Observation& o = f.map.map.Find(id)->observations.back();
        Keypoint& k = f.map.FeaturesOf(o.keyframe).keypoints[o.feature];
        k.x_px += 15 * static_cast<float>(f.scene.scales.scale(k.octave));
      }
      LocalBaOptions options = kThorough;
      options.max_iterations_after_outliers = again ? 20 : 0;
      f.DisturbPoses(1, 0.02, 0.005);
      f.DisturbPoints(0.03);
      ASSERT_TRUE(f.Adjust(options).usable);
      error[again] += RmseAligned(f.TrueCenters(), f.Centers());
    }
  }
  EXPECT_LT(error[1], error[0]);
}

TEST(LocalBa, BehindTheCameraIsAnOutlier) {
  Fixture f(4, 8, {.noise_sigmas = 0.2});
  const PointId id = f.map.truth.begin()->first;
  f.map.map.SetPosition(id, {0, 0, -5});
  f.Adjust();
  EXPECT_EQ(f.map.map.Find(id), nullptr);
  EXPECT_GT(f.map.map.NumPoints(MapId(0)), static_cast<int>(0.95 * f.map.truth.size()));
}

TEST(LocalBa, NothingToAdjust) {
  SyntheticScene scene(9);
  SyntheticMap map(scene);
  const KeyframeId k = map.AddKeyframe(scene.Look(PoseAt({0, 0, 0})));
  const BaSummary summary = AdjustLocally(map.Context(), k, kNoAxes, {}, 10);
  EXPECT_EQ(summary.observations, 0);
  EXPECT_EQ(map.map.Find(k)->cam_from_world.translation, Eigen::Vector3d::Zero());
}

TEST(LocalBa, EndsEarlyWhenOthersWait) {
  const auto iterations = [](const IsUrgent& is_urgent) {
    Fixture f(6, 10);
    f.DisturbPoses(1, 0.02, 0.005);
    f.DisturbPoints(0.02);
    const BaSummary summary = AdjustLocally(f.map.Context(), f.last(), kNoAxes, kThorough,
                                            kThorough.max_iterations, is_urgent);
    EXPECT_LT(summary.final_cost, 0.5 * summary.initial_cost);
    return summary.iterations;  // and the first evaluation
  };
  EXPECT_EQ(iterations([] { return true; }), 1 + kThorough.min_iterations_when_urgent);
  EXPECT_GT(iterations([] { return false; }), 1 + kThorough.min_iterations_when_urgent);
  EXPECT_EQ(iterations([] { return false; }), iterations({}));
}

TEST(LocalBa, SameInputSameBytesWhereverTheHeapHasRoom) {
  std::vector<std::unique_ptr<char[]>> holes;
  const auto run = [&holes](size_t bytes) {
    for (int i = 0; i < 300; ++i) holes.push_back(std::make_unique<char[]>(bytes + 7 * i));
    for (size_t i = 0; i < holes.size(); i += 3) holes[i].reset();
    Fixture f(6, 10);
    f.DisturbPoses(1, 0.02, 0.005);
    f.DisturbPoints(0.02);
    f.Adjust();
    std::vector<double> numbers;
    for (const auto& [id, p] : f.map.truth) {
      const MapPoint* point = f.map.map.Find(id);
      for (int i = 0; i < 3; ++i) numbers.push_back(point ? point->position[i] : 0);
    }
    for (const auto& c : f.Centers()) numbers.insert(numbers.end(), c.data(), c.data() + 3);
    return numbers;
  };
  const std::vector<double> once = run(16), again = run(333);
  EXPECT_EQ(once, again);
}

}  // namespace
}  // namespace vpslam
