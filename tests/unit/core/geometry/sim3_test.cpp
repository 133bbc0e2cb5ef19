#include "core/geometry/sim3.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/core/geometry/two_view_scene.h"

namespace vpslam {
namespace {

Sim3 RandomSim3(SceneMaker& maker) {
  return {ExpSo3(maker.NormalVector(1)), maker.NormalVector(5), maker.Uniform(0.1, 10)};
}

std::vector<Eigen::Vector3d> RandomPoints(SceneMaker& maker, int count) {
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) points.push_back(maker.NormalVector(3));
  return points;
}

double SumOfSquares(const Sim3& b_from_a, const std::vector<Eigen::Vector3d>& a,
                    const std::vector<Eigen::Vector3d>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (b_from_a * a[i] - b[i]).squaredNorm();
  return sum;
}

TEST(Sim3, GroupIdentities) {
  SceneMaker maker(1);
  for (int i = 0; i < 1000; ++i) {
    const Sim3 b_from_a = RandomSim3(maker), c_from_b = RandomSim3(maker);
    const Eigen::Vector3d x = maker.NormalVector(5);
    EXPECT_NEAR((c_from_b * b_from_a * x - c_from_b * (b_from_a * x)).norm(), 0, 1e-9);
    EXPECT_NEAR((b_from_a.Inverse() * (b_from_a * x) - x).norm(), 0, 1e-9);
  }
}

TEST(Sim3, TransformedWorldLooksTheSame) {
  SceneMaker maker(2);
  for (int i = 0; i < 100; ++i) {
    const Sim3 b_from_a = RandomSim3(maker);
    const SE3 cam_from_a(ExpSo3(maker.NormalVector(1)), maker.NormalVector(3));
    const SE3 cam_from_b = TransformWorld(cam_from_a, b_from_a);
    const Eigen::Vector3d x = maker.NormalVector(5);
    // Same direction in the camera, at `scale` times the distance.
    EXPECT_NEAR((cam_from_b * (b_from_a * x) - b_from_a.scale * (cam_from_a * x)).norm(), 0, 1e-9);
  }
}

TEST(AlignPoints, RecoversTheTransform) {
  SceneMaker maker(3);
  for (int trial = 0; trial < 1000; ++trial) {
    const bool with_scale = trial % 2;
    Sim3 truth = RandomSim3(maker);
    if (!with_scale) truth.scale = 1;
    const std::vector<Eigen::Vector3d> a = RandomPoints(maker, 3 + trial % 20);
    std::vector<Eigen::Vector3d> b;
    for (const Eigen::Vector3d& x : a) b.push_back(truth * x);
    const auto found = AlignPoints(a, b, with_scale);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->scale, truth.scale, 1e-9 * truth.scale);
    EXPECT_LT(AngleBetween_rad(found->rotation, truth.rotation), 1e-6);
    EXPECT_LT((found->translation - truth.translation).norm(), 1e-6);
  }
}

TEST(AlignPoints, IsTheLeastSquaresSolutionAndNeverAReflection) {
  SceneMaker maker(4);
  for (int trial = 0; trial < 100; ++trial) {
    const std::vector<Eigen::Vector3d> a = RandomPoints(maker, 10);
    std::vector<Eigen::Vector3d> b;
    const Sim3 truth = RandomSim3(maker);
    for (Eigen::Vector3d x : a) {
      if (trial % 2) x.x() = -x.x();  // mirrored: no rotation fits well
      b.push_back(truth * x + maker.NormalVector(0.3));
    }
    const auto found = AlignPoints(a, b);
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->rotation.toRotationMatrix().determinant(), 1, 1e-9);
    const double best = SumOfSquares(*found, a, b);
    for (int k = 0; k < 14; ++k) {
      const double step = k % 2 ? 1e-4 : -1e-4;
      Sim3 moved = *found;
      if (k < 6) moved.translation[k / 2] += step;
      if (k >= 6 && k < 12) {
        moved.rotation = ExpSo3(step * Eigen::Vector3d::Unit(k / 2 - 3)) * moved.rotation;
      }
      if (k >= 12) moved.scale *= 1 + step;
      EXPECT_GE(SumOfSquares(moved, a, b), best - 1e-9 * best);
    }
  }
}

TEST(AlignPoints, APlaneIsEnough) {
  SceneMaker maker(5);
  std::vector<Eigen::Vector3d> a = RandomPoints(maker, 10), b;
  const Sim3 truth = RandomSim3(maker);
  for (Eigen::Vector3d& x : a) {
    x.z() = 2;
    b.push_back(truth * x);
  }
  const auto found = AlignPoints(a, b);
  ASSERT_TRUE(found);
  EXPECT_LT(AngleBetween_rad(found->rotation, truth.rotation), 1e-6);
}

TEST(AlignPoints, RejectsDegenerateInput) {
  SceneMaker maker(6);
  const std::vector<Eigen::Vector3d> points = RandomPoints(maker, 5);
  EXPECT_FALSE(AlignPoints(std::span(points).first(2), std::span(points).first(2)));
  EXPECT_FALSE(AlignPoints(points, std::span(points).first(4)));
  EXPECT_FALSE(AlignPoints({}, {}));
  std::vector<Eigen::Vector3d> line;
  for (int i = 0; i < 5; ++i)
    line.push_back(Eigen::Vector3d(1e3, 2e3, 0) + i * Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(AlignPoints(line, points));
  EXPECT_FALSE(AlignPoints(points, line));
  EXPECT_FALSE(AlignPoints(line, line));
  const std::vector<Eigen::Vector3d> same(5, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(AlignPoints(same, points));
  EXPECT_FALSE(AlignPoints(points, same));
  std::vector<Eigen::Vector3d> invalid = points;
  invalid[1].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(AlignPoints(invalid, points));
}

}  // namespace
}  // namespace vpslam
