#include "frontend/axis_follower.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <stdexcept>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "core/geometry/so3.h"

namespace vpslam {
namespace {

using Outcome = AxisFollower::Outcome;

constexpr double kRadPerDeg = std::numbers::pi / 180;

/// All 24, made in another way than the follower's: turns by 90 degrees about x and y.
std::vector<Eigen::Matrix3d> AllNamings() {
  const auto turn = [](const Eigen::Vector3d& axis) {
    return Eigen::AngleAxisd(std::numbers::pi / 2, axis).toRotationMatrix();
  };
  std::vector<Eigen::Matrix3d> all{Eigen::Matrix3d::Identity()};
  for (size_t i = 0; i < all.size(); ++i) {
    for (const int axis_index : {0, 1}) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(axis_index);
      const Eigen::Matrix3d next = turn(axis) * all[i];
      if (std::none_of(all.begin(), all.end(),
                       [&](const auto& known) { return (known - next).norm() < 0.1; })) {
        all.push_back(next);
      }
    }
  }
  return all;
}

/// What a detector would say of `truth`, under any of the names.
LineSet Saying(const Eigen::Quaterniond& truth, const Eigen::Matrix3d& naming,
               double sigma_deg = 0.2, int support = 20) {
  LineSet set;
  set.manhattan = ManhattanState::kThree;
  set.cam_from_manhattan = Eigen::Quaterniond(truth.toRotationMatrix() * naming);
  set.covariance_rad2 = std::pow(sigma_deg * kRadPerDeg, 2) * Eigen::Matrix3d::Identity();
  set.vanishing_points.resize(3);
  for (int k = 0; k < 3; ++k) {
    set.vanishing_points[k].direction_in_cam = set.cam_from_manhattan.toRotationMatrix().col(k);
    set.vanishing_points[k].support = support;
  }
  return set;
}

Eigen::Matrix3d Turning(double sigma_deg) {
  return std::pow(sigma_deg * kRadPerDeg, 2) * Eigen::Matrix3d::Identity();
}

Eigen::Quaterniond RandomRotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
      .normalized();
}

double Degrees(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
  return AngleBetween_rad(a, b) / kRadPerDeg;
}

TEST(NearestNaming, UndoesEachOfThe24) {
  const auto all = AllNamings();
  ASSERT_EQ(all.size(), 24u);
  std::mt19937 random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Matrix3d truth = RandomRotation(random).toRotationMatrix();
    const Eigen::Matrix3d off =
        (ExpSo3(20 * kRadPerDeg * Eigen::Vector3d(0.6, -0.48, 0.64))).toRotationMatrix() * truth;
    for (const Eigen::Matrix3d& naming : all) {
      const AxisNaming found = NearestNaming(truth * naming, off);
      EXPECT_LT((truth * naming * found.Matrix() - truth).norm(), 1e-9);
      for (int k = 0; k < 3; ++k) EXPECT_EQ(found.from[found.NameOf(k)], k);
    }
  }
}

TEST(AxisFollower, FollowsATurnWhateverTheDetectorCallsTheAxes) {
  const auto all = AllNamings();
  std::mt19937 random(2);
  std::uniform_int_distribution<size_t> any(0, 23);
  AxisFollower follower({});
  const Eigen::Vector3d step_rad = 1.5 * kRadPerDeg * Eigen::Vector3d(0.6, 0.8, 0);
  Eigen::Quaterniond truth = RandomRotation(random);
  std::optional<Eigen::Quaterniond> first;     // truth^-1 followed: constant if names stay
  for (int frame = 0; frame < 400; ++frame) {  // more than one and a half turns
    truth = ExpSo3(step_rad) * truth;
    follower.Predict(Eigen::Quaterniond::Identity(), Turning(3));
    const auto update = follower.Take(Saying(truth, all[any(random)]));
    if (frame < 2) {
      EXPECT_EQ(update.outcome, Outcome::kBeginning);
      continue;
    }
    ASSERT_EQ(update.outcome, Outcome::kFollowed) << frame;
    const Eigen::Quaterniond name = truth.conjugate() * update.cam_from_manhattan;
    if (!first) first = name;
    ASSERT_LT(Degrees(name, *first), 1e-6) << frame;
    ASSERT_LT(Degrees(follower.cam_from_manhattan(), update.cam_from_manhattan), 1.5);
  }
  EXPECT_EQ(follower.generation(), 1);
}

TEST(AxisFollower, APredictionBridgesAGap) {
  const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
  AxisFollower follower({});
  Eigen::Quaterniond truth = Eigen::Quaterniond::Identity();
  for (int i = 0; i < 5; ++i) follower.Take(Saying(truth, same));
  ASSERT_TRUE(follower.IsFollowing());
  const Eigen::Quaterniond step = ExpSo3({0, 2 * kRadPerDeg, 0});
  for (int i = 0; i < 60; ++i) {  // 120 degrees without a line
    truth = step * truth;
    follower.Predict(step, Turning(0.1));
    EXPECT_EQ(follower.Take(LineSet()).outcome, Outcome::kNothing);
  }
  const auto update = follower.Take(Saying(truth, AllNamings()[7]));
  EXPECT_EQ(update.outcome, Outcome::kFollowed);
  EXPECT_LT(Degrees(update.cam_from_manhattan, truth), 1e-6);
}

TEST(AxisFollower, WithoutLinesTheAxesAreLostAndBornAnewUnderAnotherGeneration) {
  AxisFollower follower({});
  const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
  for (int i = 0; i < 5; ++i) follower.Take(Saying(Eigen::Quaterniond::Identity(), same));
  ASSERT_TRUE(follower.IsFollowing());
  int frames = 0;
  for (; follower.IsFollowing() && frames < 100; ++frames) {
    follower.Predict(Eigen::Quaterniond::Identity(), Turning(3));
  }
  EXPECT_NEAR(frames, 6, 1) << "7.5 degrees are 2.5 times 3, and variances add up";
  for (int i = 0; i < 3; ++i) follower.Take(Saying(ExpSo3({0, 0.6, 0}), same));
  EXPECT_TRUE(follower.IsFollowing());
  EXPECT_EQ(follower.generation(), 2);
}

TEST(AxisFollower, RefusesWhatHasLittleSupportOrMuchSpread) {
  AxisFollower follower({});
  const Eigen::Quaterniond truth = Eigen::Quaterniond::Identity();
  const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
  EXPECT_EQ(follower.Take(Saying(truth, same, 0.2, 4)).outcome, Outcome::kPoor);
  EXPECT_EQ(follower.Take(Saying(truth, same, 1.1)).outcome, Outcome::kPoor);
  LineSet two_axes = Saying(truth, same);
  two_axes.manhattan = ManhattanState::kTwo;
  two_axes.vanishing_points[1].support = 0;
  EXPECT_EQ(follower.Take(two_axes).outcome, Outcome::kBeginning);
  two_axes.vanishing_points[2].support = 4;
  EXPECT_EQ(follower.Take(two_axes).outcome, Outcome::kPoor) << "one axis is no rotation";
}

TEST(AxisFollower, AMisfitIsRefusedButManyOfThemAreRight) {
  AxisFollowerOptions options;
  AxisFollower follower(options);
  const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
  const Eigen::Quaterniond truth = Eigen::Quaterniond::Identity(), other = ExpSo3({0, 0, 0.3});
  for (int i = 0; i < 10; ++i) {
    follower.Predict(Eigen::Quaterniond::Identity(), Turning(0.2));
    follower.Take(Saying(truth, same));
  }
  follower.Predict(Eigen::Quaterniond::Identity(), Turning(0.2));
  EXPECT_EQ(follower.Take(Saying(other, same)).outcome, Outcome::kMisfit);
  EXPECT_LT(Degrees(follower.cam_from_manhattan(), truth), 0.01);
  EXPECT_EQ(follower.Take(Saying(truth, same)).outcome, Outcome::kFollowed);
  for (int i = 0; i < options.misfits_to_loss; ++i) {
    EXPECT_TRUE(follower.IsFollowing());
    EXPECT_EQ(follower.Take(Saying(other, same)).outcome, Outcome::kMisfit);
  }
  EXPECT_FALSE(follower.IsFollowing());
  for (int i = 0; i < 3; ++i) follower.Take(Saying(other, same));
  EXPECT_EQ(follower.generation(), 2);
  EXPECT_LT(Degrees(follower.cam_from_manhattan(), other), 0.01);
}

TEST(AxisFollower, IsNotBornOfMeasurementsThatContradictEachOther) {
  AxisFollower follower({});
  const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
  for (int i = 0; i < 30; ++i) {
    follower.Predict(Eigen::Quaterniond::Identity(), Turning(1));
    follower.Take(Saying(ExpSo3({0.3 * (i % 2), 0, 0}), same));
    EXPECT_FALSE(follower.IsFollowing());
  }
}

TEST(AxisFollower, CovarianceGrowsWithTurnsAndShrinksWithMeasurementsButNotToNothing) {
  AxisFollowerOptions options;
  AxisFollower follower(options);
  const Eigen::Matrix3d same = Eigen::Matrix3d::Identity();
  const double sigma_rad = 0.2 * kRadPerDeg;
  for (int i = 0; i < 200; ++i) follower.Take(Saying(Eigen::Quaterniond::Identity(), same, 0.2));
  EXPECT_NEAR(follower.covariance_rad2()(0, 0) / (sigma_rad * sigma_rad), options.correlation,
              1e-6);
  const double before = follower.covariance_rad2()(1, 1);
  follower.Predict(ExpSo3({0.1, 0.2, 0.3}), Turning(1));
  EXPECT_NEAR(follower.covariance_rad2()(1, 1), before + kRadPerDeg * kRadPerDeg, 1e-12);
  follower.Take(Saying(follower.cam_from_manhattan(), same, 0.001));
  EXPECT_GE(std::sqrt(follower.covariance_rad2()(2, 2)) / kRadPerDeg,
            options.min_sigma_deg * std::sqrt(options.correlation) - 1e-9)
      << "the floor";
}

TEST(AxisFollower, RefusesOptionsWithoutSense) {
  AxisFollowerOptions options;
  options.max_innovation_deg = 45;
  EXPECT_THROW(AxisFollower{options}, std::invalid_argument);
  options = {};
  options.max_sigma_deg = options.min_sigma_deg;
  EXPECT_THROW(AxisFollower{options}, std::invalid_argument);
}

}  // namespace
}  // namespace vpslam
