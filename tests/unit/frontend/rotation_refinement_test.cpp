#include "frontend/rotation_refinement.h"

#include <numbers>

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "tests/unit/frontend/tracking_scene.h"

namespace vpslam {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

/// All rotations that turn a cube onto itself: the ways to name three axes.
std::vector<Eigen::Matrix3d> Namings() {
  std::vector<Eigen::Matrix3d> result;
  std::array<int, 3> p{0, 1, 2};
  do {
    for (int signs = 0; signs < 8; ++signs) {
      Eigen::Matrix3d m = Eigen::Matrix3d::Zero();
      for (int k = 0; k < 3; ++k) m(p[k], k) = signs >> k & 1 ? -1 : 1;
      if (m.determinant() > 0) result.push_back(m);
    }
  } while (std::next_permutation(p.begin(), p.end()));
  return result;
}

class RotationRefinement : public testing::Test {
 protected:
  RotationRefinement() {
    camera_.width = 640;
    camera_.height = 480;
    camera_.fx = camera_.fy = 500;
    camera_.cx = 320;
    camera_.cy = 240;
  }
  double Uniform() { return std::uniform_real_distribution<double>(-1, 1)(rng_); }
  Eigen::Vector3d Vector(double scale) {
    const double x = Uniform(), y = Uniform(), z = Uniform();
    return scale * Eigen::Vector3d(x, y, z);
  }
  /// Eight segments along each of the first `num_axes` axes, named by `naming`.
  LineSet Look(const Eigen::Quaterniond& cam_from_world, int num_axes = 3,
               const Eigen::Matrix3d& naming = Eigen::Matrix3d::Identity()) {
    const Eigen::Matrix3d cam_from_manhattan =
        (cam_from_world * world_from_manhattan_).toRotationMatrix();
    LineSet set;
    set.manhattan = num_axes == 3 ? ManhattanState::kThree : ManhattanState::kTwo;
    const Eigen::Matrix3d named = cam_from_manhattan * naming;
    set.cam_from_manhattan = Eigen::Quaterniond(named);
    set.covariance_rad2 = Eigen::Vector3d(1e-5, 2e-5, 3e-5).asDiagonal();
    for (int k = 0; k < 3; ++k) {
      int axis = 0;  // whose name is k
      naming.col(k).cwiseAbs().maxCoeff(&axis);
      VanishingPoint vp;
      vp.direction_in_cam = named.col(k);
      vp.support = axis < num_axes ? 8 : 0;
      set.vanishing_points.push_back(vp);
      for (int i = 0; i < vp.support; ++i) set.lines.push_back(Segment(named.col(k), k));
    }
    return set;
  }
  LineSegment Segment(const Eigen::Vector3d& direction, int label) {
    for (;;) {
      const Eigen::Vector3d start = Eigen::Vector3d(0, 0, 4) + Vector(1);
      const Eigen::Vector3d end = start + direction;
      if (end.z() < 1) continue;
      LineSegment s;
      s.start_px = camera_.Project(start).cast<float>();
      s.end_px = camera_.Project(end).cast<float>();
      s.label = label;
      if ((s.end_px - s.start_px).norm() > 20) return s;
    }
  }

  Camera camera_;
  std::mt19937_64 rng_{1};
  const Eigen::Quaterniond world_from_manhattan_ = ExpSo3({0.3, -0.5, 0.2});
  const VpRotationOptions options_;
};

TEST_F(RotationRefinement, PaperTakesAxesOnceAndThenOverwrites) {
  for (int trial = 0; trial < 20; ++trial) {
    PaperRotation paper(camera_, options_);
    const Eigen::Quaterniond first = ExpSo3(Vector(0.5));
    Eigen::Quaterniond rotation = first;
    EXPECT_FALSE(paper.Refine(Look(first), &rotation));
    EXPECT_EQ(rotation.coeffs(), first.coeffs()) << "the axes are taken from it";
    const Eigen::Quaterniond truth = ExpSo3(Vector(0.2)) * first;
    rotation = ExpSo3(4 * kRadPerDeg * Vector(1).normalized()) * truth;
    EXPECT_TRUE(paper.Refine(Look(truth), &rotation));
    // Single precision of pixels.
    EXPECT_LT(AngleBetween_rad(rotation, truth), 3e-4);
  }
}

TEST_F(RotationRefinement, PaperDoesNotCareForNamesAndSigns) {
  const Eigen::Quaterniond first = ExpSo3({0.1, 0.2, -0.1}), truth = ExpSo3({0.2, 0.1, 0});
  for (const Eigen::Matrix3d& naming : Namings()) {
    PaperRotation paper(camera_, options_);
    Eigen::Quaterniond rotation = first;
    paper.Refine(Look(first), &rotation);
    rotation = ExpSo3({0.02, -0.03, 0.02}) * truth;
    EXPECT_TRUE(paper.Refine(Look(truth, 3, naming), &rotation));
    EXPECT_LT(AngleBetween_rad(rotation, truth), 3e-4);
  }
}

TEST_F(RotationRefinement, PaperNeedsTwoAxes) {
  PaperRotation paper(camera_, options_);
  const Eigen::Quaterniond first = ExpSo3({0.1, 0.2, -0.1}), truth = ExpSo3({0.2, 0.1, 0});
  const Eigen::Quaterniond off = ExpSo3({0.02, -0.03, 0.02}) * truth;
  Eigen::Quaterniond rotation = first;
  EXPECT_FALSE(paper.Refine(Look(first, 1), &rotation)) << "no axes from one";
  EXPECT_FALSE(paper.Refine(Look(first, 2), &rotation)) << "they are taken here";
  rotation = off;
  EXPECT_FALSE(paper.Refine(Look(truth, 1), &rotation));
  EXPECT_EQ(rotation.coeffs(), off.coeffs());
  EXPECT_TRUE(paper.Refine(Look(truth, 2), &rotation));
  EXPECT_LT(AngleBetween_rad(rotation, truth), 3e-4);
  // The third is known from the two: another pair is seen now.
  LineSet set = Look(truth);
  std::erase_if(set.lines, [](const LineSegment& s) { return s.label == 0; });
  rotation = off;
  EXPECT_TRUE(paper.Refine(set, &rotation));
  EXPECT_LT(AngleBetween_rad(rotation, truth), 3e-4);
}

TEST_F(RotationRefinement, PaperLeavesWhatLiesTooFarOff) {
  PaperRotation paper(camera_, options_);
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  paper.Refine(Look(rotation), &rotation);
  const Eigen::Quaterniond truth = ExpSo3({0.1, 0.1, 0});
  const Eigen::Quaterniond off =
      ExpSo3(15 * kRadPerDeg * Eigen::Vector3d(1, 1, 1).normalized()) * truth;
  rotation = off;
  EXPECT_FALSE(paper.Refine(Look(truth), &rotation));
  EXPECT_EQ(rotation.coeffs(), off.coeffs());
  // A new map has axes of its own.
  paper.Reset();
  EXPECT_FALSE(paper.Refine(Look(truth), &rotation));
  EXPECT_TRUE(paper.Refine(Look(truth), &rotation));
  EXPECT_LT(AngleBetween_rad(rotation, off), 3e-4);
}

TEST_F(RotationRefinement, MeasuredRotationDoesNotCareForNamesAndSigns) {
  for (int trial = 0; trial < 10; ++trial) {
    const Eigen::Quaterniond truth = ExpSo3(Vector(2));
    const Eigen::Quaterniond predicted = ExpSo3(4 * kRadPerDeg * Vector(1).normalized()) * truth;
    for (const Eigen::Matrix3d& naming : Namings()) {
      for (const int num_axes : {2, 3}) {
        const auto measured = MeasureRotation(Look(truth, num_axes, naming), world_from_manhattan_,
                                              predicted, options_);
        ASSERT_TRUE(measured);
        EXPECT_LT(AngleBetween_rad(measured->cam_from_world, truth), 1e-7);
      }
    }
  }
}

TEST_F(RotationRefinement, MeasuredRotationIsAsSureAsItsDetectorAndOurDoubt) {
  const Eigen::Quaterniond truth = ExpSo3({0.1, 0.2, 0.3});
  const LineSet set = Look(truth);
  const auto measured = MeasureRotation(set, world_from_manhattan_, truth, options_);
  ASSERT_TRUE(measured);
  const double extra_rad = options_.extra_sigma_deg * kRadPerDeg;
  const Eigen::Matrix3d covariance =
      set.covariance_rad2 + extra_rad * extra_rad * Eigen::Matrix3d::Identity();
  EXPECT_NEAR((measured->information * covariance - Eigen::Matrix3d::Identity()).norm(), 0, 1e-9);
}

TEST_F(RotationRefinement, MeasuredRotationMustBeSoundAndNear) {
  const Eigen::Quaterniond truth = ExpSo3({0.1, 0.2, 0.3});
  const auto at = [&](const LineSet& set, double off_deg) {
    const Eigen::Quaterniond predicted =
        ExpSo3(off_deg * kRadPerDeg * Eigen::Vector3d(1, -1, 2).normalized()) * truth;
    return MeasureRotation(set, world_from_manhattan_, predicted, options_).has_value();
  };
  EXPECT_TRUE(at(Look(truth), 0));
  EXPECT_TRUE(at(Look(truth), options_.max_innovation_deg - 0.1));
  EXPECT_FALSE(at(Look(truth), options_.max_innovation_deg + 0.1));
  EXPECT_FALSE(at(Look(truth), 45));
  EXPECT_FALSE(at(Look(truth, 1), 0));
  LineSet vague = Look(truth);
  vague.covariance_rad2(1, 1) = std::pow(1.1 * options_.max_sigma_deg * kRadPerDeg, 2);
  EXPECT_FALSE(at(vague, 0));
  LineSet none = Look(truth);
  none.manhattan = ManhattanState::kNone;
  EXPECT_FALSE(at(none, 0));
}

TEST(RefineTranslation, FindsThePlaceWhenTheRotationIsRight) {
  for (const auto mode : {TranslationMode::kPaper, TranslationMode::kWeighted}) {
    TrackingScene s(1, {.noise_sigmas = 0});
    Frame frame = s.TrackedFrame(PoseAt({0.3, 0, 0}, {0.02, 0.03, 0}), 0);
    const Eigen::Vector3d truth = frame.placement.cam_from_world.translation;
    std::mt19937_64 rng(1);
    frame.placement.cam_from_world.translation += Eigen::Vector3d(0.1, -0.1, 0.2);
    const Eigen::Vector3d off = frame.placement.cam_from_world.translation;
    RefineTranslation(s.context(), TranslationMode::kOff, 20, rng, &frame);
    EXPECT_EQ(frame.placement.cam_from_world.translation, off);
    RefineTranslation(s.context(), mode, 100000, rng, &frame);
    EXPECT_EQ(frame.placement.cam_from_world.translation, off) << "too few points";
    RefineTranslation(s.context(), mode, 20, rng, &frame);
    // Single precision of key points.
    EXPECT_NEAR((frame.placement.cam_from_world.translation - truth).norm(), 0, 1e-5);
    SE3 pose = frame.placement.cam_from_world;
    pose.translation = off;
    frame.PlaceIn(frame.placement.map(), pose);
    RefineTranslation(s.context(), mode, 20, rng, &frame);
    EXPECT_EQ(frame.placement.cam_from_world.translation, off);
  }
}

}  // namespace
}  // namespace vpslam
