#include "backend/manhattan_frames.h"

#include <numbers>
#include <random>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/geometry/axis_naming.h"
#include "core/geometry/so3.h"
#include "core/map/invariants.h"

namespace vpslam {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

class ManhattanFramesTest : public testing::Test {
 protected:
  Eigen::Vector3d Noise(double sigma_deg) {
    return sigma_deg * kRadPerDeg * Eigen::Vector3d(normal_(rng_), normal_(rng_), normal_(rng_));
  }

  /// A keyframe whose camera sees the axes of `truth` with that error, under names of its own.
  void AddKeyframe(const Eigen::Quaterniond& truth, double sigma_deg) {
    Keyframe keyframe;
    keyframe.id = KeyframeId(next_++);
    keyframe.map = map_id_;
    const Keyframe* before = map_.Find(KeyframeId(keyframe.id.value - 1));
    if (before && before->map == map_id_) keyframe.parent = before->id;
    keyframe.cam_from_world = SE3(ExpSo3({0.1 * next_, 0.4, -0.05 * next_}), {1.0 * next_, 0, 0});
    map_.Insert(keyframe);
    LineSet lines;
    lines.manhattan = ManhattanState::kThree;
    lines.vanishing_points.resize(3);
    for (VanishingPoint& vp : lines.vanishing_points) vp.support = 10;
    const Eigen::Quaterniond renamed =
        next_ % 2
            ? Eigen::Quaterniond(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitX()))
            : Eigen::Quaterniond::Identity();
    lines.cam_from_manhattan =
        ExpSo3(Noise(sigma_deg)) * keyframe.cam_from_world.rotation * truth * renamed;
    lines.covariance_rad2 = std::pow(sigma_deg * kRadPerDeg, 2) * Eigen::Matrix3d::Identity();
    Change(&lines);
    frames_.Add(keyframe.id, lines);
    if (update_) frames_.Update(map_id_, &map_);
  }
  virtual void Change(LineSet*) {}

  /// Of the only frame; none if there is none.
  std::optional<Eigen::Quaterniond> World() const {
    const std::vector<Eigen::Quaterniond> worlds = frames_.worlds_from_manhattan();
    EXPECT_LE(worlds.size(), 1u);
    return worlds.empty() ? std::nullopt : std::optional(worlds.front());
  }

  /// Up to names of the axes.
  double Error_deg(const Eigen::Quaterniond& truth) const {
    double least = 180;
    for (int i = 0; i < 4; ++i) {
      const Eigen::Quaterniond turn(
          Eigen::AngleAxisd(i * std::numbers::pi / 2, Eigen::Vector3d::UnitX()));
      least = std::min(least, AngleBetween_rad(*World(), truth * turn));
    }
    return least / kRadPerDeg;
  }

  std::mt19937 rng_{1};
  std::normal_distribution<double> normal_{0, 1};
  ManhattanOptions options_;
  ManhattanFrames frames_{options_};
  OwnedMap map_;
  MapId map_id_{0};
  int next_ = 0;
  bool update_ = true;
  const Eigen::Quaterniond truth_ = ExpSo3({0.3, -0.5, 0.2});
};

TEST_F(ManhattanFramesTest, IsBornWhenKeyframesAgreeAndBindsThem) {
  for (int i = 0; i < options_.keyframes_to_birth; ++i) {
    EXPECT_FALSE(World());
    AddKeyframe(truth_, 0.2);
  }
  ASSERT_TRUE(World());
  for (int i = 0; i < options_.keyframes_to_birth; ++i) {
    const std::optional<ManhattanBinding> m = frames_.Find(KeyframeId(i));
    ASSERT_TRUE(m);
    const Eigen::Quaterniond predicted =
        map_.Find(KeyframeId(i))->cam_from_world.rotation * *World();
    EXPECT_LT(AngleBetween_rad(m->measurement.cam_from_manhattan, predicted), 1.5 * kRadPerDeg);
  }
}

TEST_F(ManhattanFramesTest, BindsANewKeyframeBeforeItIsAdjusted) {
  for (int i = 0; i < options_.keyframes_to_birth; ++i) AddKeyframe(truth_, 0.2);
  update_ = false;
  for (const bool fits : {true, false}) {
    AddKeyframe(fits ? truth_ : ExpSo3({0, 0.2, 0}) * truth_, 0.2);
    const Keyframe& keyframe = *map_.Find(KeyframeId(next_ - 1));
    EXPECT_FALSE(frames_.Find(keyframe.id));
    frames_.Expect(keyframe);
    const std::optional<ManhattanBinding> m = frames_.Find(keyframe.id);
    ASSERT_EQ(m.has_value(), fits);
    if (!fits) continue;
    EXPECT_LT(AngleBetween_rad(m->measurement.cam_from_manhattan,
                               keyframe.cam_from_world.rotation * *World()),
              1.5 * kRadPerDeg);
  }
  Keyframe stranger = *map_.Find(KeyframeId(0));
  stranger.id = KeyframeId(100);
  frames_.Expect(stranger);
  EXPECT_FALSE(frames_.Find(stranger.id));
}

TEST_F(ManhattanFramesTest, IsTheMeanOfAllKeyframes) {
  for (int i = 0; i < 100; ++i) AddKeyframe(truth_, 0.5);
  ASSERT_TRUE(World());
  // 0.5 degrees in each of three directions, from 100 measurements: 0.087 in all.
  EXPECT_LT(Error_deg(truth_), 0.25);
}

TEST_F(ManhattanFramesTest, IsNotBornOfKeyframesThatDisagree) {
  for (int i = 0; i < 30; ++i)
    AddKeyframe(truth_ * ExpSo3({0.15 * (i % 4), 0, 0.1 * (i % 3)}), 0.2);
  EXPECT_FALSE(World());
}

TEST_F(ManhattanFramesTest, LeavesOutWhatDoesNotFit) {
  for (int i = 0; i < 10; ++i) AddKeyframe(truth_, 0.2);
  AddKeyframe(truth_ * ExpSo3({0.2, 0, 0}), 0.2);
  EXPECT_FALSE(frames_.Find(KeyframeId(10)));
  EXPECT_TRUE(frames_.Find(KeyframeId(9)));
  EXPECT_LT(Error_deg(truth_), 0.3);
}

TEST_F(ManhattanFramesTest, BindsAKeyframeThatHasTurnedButDoesNotFollowIt) {
  for (int i = 0; i < 10; ++i) AddKeyframe(truth_, 0.1);
  const double turn_deg = 0.5 * (options_.max_innovation_deg + options_.max_correction_deg);
  for (int i = 0; i < 3; ++i) AddKeyframe(truth_ * ExpSo3({turn_deg * kRadPerDeg, 0, 0}), 0.1);
  for (int i = 0; i < 13; ++i) EXPECT_TRUE(frames_.Find(KeyframeId(i))) << i;
  EXPECT_LT(Error_deg(truth_), 0.2);
}

TEST_F(ManhattanFramesTest, IsForgottenWhenTheSceneIsAnother) {
  for (int i = 0; i < 10; ++i) AddKeyframe(truth_, 0.2);
  for (int i = 0; i < 6; ++i) AddKeyframe(truth_ * ExpSo3({0.2 + 0.1 * i, 0.3, 0}), 0.2);
  EXPECT_FALSE(World());
  const Eigen::Quaterniond other = truth_ * ExpSo3({0.3, 0.3, 0});
  for (int i = 0; i < 10; ++i) AddKeyframe(other, 0.2);
  ASSERT_TRUE(World());
  EXPECT_LT(Error_deg(other), 0.5);
}

TEST_F(ManhattanFramesTest, IsKeptWhereTheCameraSlips) {
  for (int i = 0; i < 10; ++i) AddKeyframe(truth_, 0.1);
  const double slip_deg = 0.5 * (options_.max_innovation_deg + options_.max_correction_deg);
  for (int i = 0; i < 2 * options_.loss_window; ++i) {
    AddKeyframe(truth_ * ExpSo3({slip_deg * kRadPerDeg, 0, 0}), 0.1);
  }
  ASSERT_TRUE(World());
  EXPECT_LT(Error_deg(truth_), 0.2);
}

/// A building with a wing that stands at an angle to the rest: into the wing, and back.
class WingTest : public ManhattanFramesTest, public testing::WithParamInterface<double> {
 protected:
  void Walk(int rooms, int wing, int back) {
    for (int i = 0; i < rooms; ++i) AddKeyframe(truth_, 0.2);
    for (int i = 0; i < wing; ++i) AddKeyframe(wing_, 0.2);
    for (int i = 0; i < back; ++i) AddKeyframe(truth_, 0.2);
  }
  /// The frame that the keyframe belongs to, as the map has it.
  const ManhattanAxes& AxesOf(int keyframe) const {
    return *map_.Find(map_.Find(KeyframeId(keyframe))->manhattan);
  }
  static double Difference_deg(const Eigen::Quaterniond& a, const Eigen::Quaterniond& b) {
    return AngleBetween_rad(NamedNearest(a, b), b) / kRadPerDeg;
  }

  const Eigen::Quaterniond wing_ = truth_ * ExpSo3({0, GetParam() * kRadPerDeg, 0});
};

TEST_P(WingTest, HasAFrameOfItsOwnAndTheRestKeepsIts) {
  Walk(25, 25, 25);
  ASSERT_EQ(map_.ManhattanFrames(map_id_).size(), 2u);
  for (int i = 0; i < 75; ++i) {
    const bool in_wing = i >= 25 && i < 50;
    EXPECT_LT(Difference_deg(AxesOf(i).world_from_manhattan, in_wing ? wing_ : truth_), 0.3) << i;
    const auto binding = frames_.Find(KeyframeId(i));
    ASSERT_TRUE(binding) << i;
    EXPECT_LT(Difference_deg(binding->world_from_manhattan, in_wing ? wing_ : truth_), 0.3) << i;
  }
  EXPECT_EQ(AxesOf(0).id, AxesOf(74).id) << "the frame is found again";
  EXPECT_EQ(CheckInvariants(map_), std::nullopt);
}

TEST_P(WingTest, WhatTellsNothingBelongsWhereItIs) {
  Walk(25, 25, 0);
  Keyframe keyframe = *map_.Find(KeyframeId(next_ - 1));
  keyframe.parent = keyframe.id;
  keyframe.id = KeyframeId(next_++);
  keyframe.manhattan = {};
  map_.Insert(keyframe);
  frames_.Update(map_id_, &map_);
  EXPECT_EQ(map_.Find(keyframe.id)->manhattan, AxesOf(49).id);
  EXPECT_FALSE(frames_.Find(keyframe.id));
}

TEST_P(WingTest, WhereNothingAgreesAFrameOfManyKeyframesStays) {
  Walk(options_.keyframes_to_confirm, 0, 0);
  for (int i = 0; i < 15; ++i) {
    AddKeyframe(truth_ * ExpSo3({0, (GetParam() + 5 * (i % 4)) * kRadPerDeg, 0.1}), 0.2);
  }
  ASSERT_TRUE(World());
  EXPECT_LT(Error_deg(truth_), 0.3);
}

INSTANTIATE_TEST_SUITE_P(Angles, WingTest, testing::Values(30, 45, 15));

/// Keyframes of this frame, and then those of another, whose world is turned and who see the axes
/// askew by so much.
class JoinedFramesTest : public ManhattanFramesTest {
 protected:
  void See(const std::vector<double>& askew_deg) {
    for (int i = 0; i < 10; ++i) AddKeyframe(truth_, 0.1);
    std::swap(frames_, other_);
    map_id_ = MapId(1);
    for (const double askew : askew_deg) {
      AddKeyframe(other_from_world_ * ExpSo3({0, askew * kRadPerDeg, 0}) * truth_, 0.1);
    }
    std::swap(frames_, other_);
  }
  std::optional<Eigen::Quaterniond> Turn() const {
    return frames_.TurnOf(other_, other_from_world_.conjugate(), map_);
  }

  ManhattanFrames other_{options_};
  const Eigen::Quaterniond other_from_world_ = ExpSo3({0.7, -1.1, 2});
};

TEST_F(JoinedFramesTest, TellHowFarTheOtherIsAskew) {
  See(std::vector<double>(20, 5.0));
  const auto turn = Turn();
  ASSERT_TRUE(turn);
  // 0.1 deg in each of three directions, from ten measurements and twenty.
  EXPECT_LT(AngleBetween_rad(*turn, ExpSo3({0, -5 * kRadPerDeg, 0})), 0.15 * kRadPerDeg);
  EXPECT_FALSE(frames_.Contradicts(*turn));
}

TEST_F(JoinedFramesTest, OutliersAreOutvoted) {
  std::vector<double> askew(20, 5.0);
  for (int i = 0; i < 6; ++i) askew[3 * i] = 15;
  See(askew);
  const auto turn = Turn();
  ASSERT_TRUE(turn);
  EXPECT_LT(AngleBetween_rad(*turn, ExpSo3({0, -5 * kRadPerDeg, 0})), 0.2 * kRadPerDeg);
}

TEST_F(JoinedFramesTest, AskewByMuchIsAContradiction) {
  See(std::vector<double>(20, 20.0));
  const auto turn = Turn();
  ASSERT_TRUE(turn);
  EXPECT_TRUE(frames_.Contradicts(*turn));
}

TEST_F(JoinedFramesTest, DisagreeingSayNothing) {
  See({0, 5, -5, 10, -10, 15, -15, 20, -20});
  EXPECT_FALSE(Turn());
}

TEST_F(JoinedFramesTest, FewSayNothing) {
  See(std::vector<double>(options_.keyframes_to_birth - 1, 5.0));
  EXPECT_FALSE(Turn());
}

TEST_F(JoinedFramesTest, WithoutAFrameThereIsNoTurn) {
  See(std::vector<double>(20, 5.0));
  EXPECT_FALSE(ManhattanFrames(options_).TurnOf(other_, other_from_world_.conjugate(), map_));
}

class OverconfidentTest : public ManhattanFramesTest, public testing::WithParamInterface<double> {
 protected:
  void Change(LineSet* lines) override { lines->covariance_rad2 *= 1e-4; }
  double Sigma_deg(int keyframe) const {
    return std::sqrt(frames_.Find(KeyframeId(keyframe))->measurement.covariance_rad2.trace() / 3) /
           kRadPerDeg;
  }
};

TEST_P(OverconfidentTest, AreBelievedAsFarAsTheyAgree) {
  for (int i = 0; i < 100; ++i) AddKeyframe(truth_, GetParam());
  ASSERT_TRUE(World());
  for (const int i : {0, 50, 99}) {
    ASSERT_TRUE(frames_.Find(KeyframeId(i))) << i;
    EXPECT_NEAR(Sigma_deg(i), std::max(GetParam(), options_.min_sigma_deg), 0.25 * GetParam());
  }
}

INSTANTIATE_TEST_SUITE_P(Errors, OverconfidentTest, testing::Values(0.01, 0.3, 0.8));

class PoorlySeenTest : public ManhattanFramesTest, public testing::WithParamInterface<int> {
 protected:
  void Change(LineSet* lines) override {
    if (GetParam() == 0) lines->manhattan = ManhattanState::kNone;
    if (GetParam() == 1)
      lines->vanishing_points[0].support = lines->vanishing_points[2].support = 2;
    if (GetParam() == 2) lines->covariance_rad2(1, 1) = std::pow(5 * kRadPerDeg, 2);
    if (GetParam() == 3) lines->covariance_rad2(0, 0) = std::nan("");
    if (GetParam() == 4) lines->vanishing_points.clear();
  }
};

TEST_P(PoorlySeenTest, SaysNothing) {
  for (int i = 0; i < 20; ++i) AddKeyframe(truth_, 0.2);
  EXPECT_FALSE(World());
}

INSTANTIATE_TEST_SUITE_P(All, PoorlySeenTest, testing::Range(0, 5));

}  // namespace
}  // namespace vpslam
