#include "core/estimation/absolute_rotation.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "core/geometry/so3.h"
#include "core/geometry/sphere.h"
#include "tests/unit/test_camera.h"

namespace vpslam {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

class AbsoluteRotation : public testing::Test {
 protected:
  Eigen::Vector3d Normal(double sigma = 1) {
    const double x = normal_(rng_), y = normal_(rng_), z = normal_(rng_);
    return sigma * Eigen::Vector3d(x, y, z);
  }
  /// Normals of planes that contain the direction, each off by `sigma_rad`.
  std::vector<Eigen::Vector3d> Normals(const Eigen::Vector3d& direction, int count,
                                       double sigma_rad) {
    std::vector<Eigen::Vector3d> normals;
    for (int i = 0; i < count; ++i) {
      const Eigen::Vector3d exact = direction.cross(Normal()).normalized();
      normals.push_back((exact + Normal(sigma_rad)).normalized());
    }
    return normals;
  }
  /// The columns of a rotation seen by a camera at `rotation`, with noise and of any sign.
  std::vector<DirectionPair> Pairs(const Eigen::Quaterniond& rotation, int count,
                                   double sigma_rad) {
    const Eigen::Matrix3d world = ExpSo3(Normal()).toRotationMatrix();
    std::vector<DirectionPair> pairs;
    for (int k = 0; k < count; ++k) {
      const Eigen::Vector3d seen = (rotation * world.col(k) + Normal(sigma_rad)).normalized();
      pairs.push_back({rng_() % 2 ? Eigen::Vector3d(-seen) : seen, world.col(k)});
    }
    return pairs;
  }

  std::mt19937 rng_{1};
  std::normal_distribution<double> normal_{0, 1};
};

TEST_F(AbsoluteRotation, Eq2IsExactWithoutNoise) {
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d truth = Normal().normalized();
    for (const int count : {2, 3, 40}) {
      const auto found = DominantDirection(Normals(truth, count, 0));
      ASSERT_TRUE(found);
      EXPECT_NEAR(found->norm(), 1, 1e-9);
      EXPECT_LT(AxisAngle_rad(*found, truth), 1e-8);
    }
  }
}

TEST_F(AbsoluteRotation, Eq2ErrorsAgreeWithTheNoise) {
  constexpr int kTrials = 400;
  constexpr double kSigma_rad = 0.005;
  double sum = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::Vector3d truth = Normal().normalized();
    const auto normals = Normals(truth, 20, kSigma_rad);
    const auto found = DominantDirection(normals);
    ASSERT_TRUE(found);
    // s . d = 0 within sigma: the information of least squares in the tangent plane.
    const Eigen::Matrix<double, 3, 2> tangent = TangentBasis(truth);
    Eigen::Matrix2d information = Eigen::Matrix2d::Zero();
    for (const Eigen::Vector3d& s : normals) {
      const Eigen::Vector2d row = tangent.transpose() * s;
      information += row * row.transpose() / (kSigma_rad * kSigma_rad);
    }
    const Eigen::Vector2d error = tangent.transpose() * *found;
    sum += error.dot(information * error);
  }
  // Chi-square with two degrees of freedom: the mean of 400 has a standard deviation of 0.1.
  EXPECT_NEAR(sum / kTrials, 2, 0.4);
}

TEST_F(AbsoluteRotation, Eq2NeedsTwoPlanes) {
  const Eigen::Vector3d s = Normal().normalized();
  EXPECT_FALSE(DominantDirection({}));
  EXPECT_FALSE(DominantDirection(std::vector{s}));
  EXPECT_FALSE(DominantDirection(std::vector{s, s}));
  EXPECT_FALSE(DominantDirection(std::vector<Eigen::Vector3d>{s, -s, s}));
  EXPECT_FALSE(DominantDirection(std::vector<Eigen::Vector3d>(5, Eigen::Vector3d::Zero())));
}

/// Segments that point to the axes of a camera at `rotation`, and clutter without label.
LineSet SegmentsAlong(const Eigen::Matrix3d& cam_from_manhattan, const Camera& camera,
                      const std::array<int, 3>& counts, std::mt19937* rng) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  LineSet lines;
  lines.manhattan = ManhattanState::kThree;
  lines.vanishing_points.resize(3);
  const auto add = [&](const Eigen::Vector3d& direction, int label) {
    for (;;) {
      const double x = uniform(*rng), y = uniform(*rng), z = uniform(*rng);
      const Eigen::Vector3d start(x, y, 4 + z);
      const Eigen::Vector3d end = start + direction;
      if (end.z() < 1) continue;
      LineSegment segment;
      segment.start_px = camera.Project(start).cast<float>();
      segment.end_px = camera.Project(end).cast<float>();
      if ((segment.start_px - segment.end_px).norm() < 20) continue;
      segment.label = label;
      lines.lines.push_back(segment);
      return;
    }
  };
  for (int axis = 0; axis < 3; ++axis) {
    for (int i = 0; i < counts[axis]; ++i) add(cam_from_manhattan.col(axis), axis);
    add(Eigen::Vector3d(0.3, 0.5, 0.1), -1);
  }
  return lines;
}

TEST_F(AbsoluteRotation, DirectionsComeFromTheLinesOfTheirLabel) {
  const Camera camera = TestCamera();
  // Also where the image plane is parallel to two axes: their vanishing points are at infinity.
  for (const Eigen::Vector3d& turn :
       {Eigen::Vector3d(0.3, -0.4, 0.2), Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0, 0.5, 0)}) {
    const Eigen::Matrix3d truth = ExpSo3(turn).toRotationMatrix();
    const LineSet lines = SegmentsAlong(truth, camera, {8, 8, 8}, &rng_);
    const auto found = DominantDirections(lines, camera, 8);
    for (int k = 0; k < 3; ++k) {
      ASSERT_TRUE(found[k]);
      // Single precision of pixels.
      EXPECT_LT(AxisAngle_rad(*found[k], truth.col(k)), 1e-4);
    }
  }
}

TEST_F(AbsoluteRotation, AxesWithFewLinesHaveNoDirection) {
  const Camera camera = TestCamera();
  const Eigen::Matrix3d truth = ExpSo3({0.3, -0.4, 0.2}).toRotationMatrix();
  LineSet lines = SegmentsAlong(truth, camera, {5, 4, 5}, &rng_);
  const auto found = DominantDirections(lines, camera, 5);
  EXPECT_TRUE(found[0]);
  EXPECT_FALSE(found[1]);
  EXPECT_TRUE(found[2]);
  lines.manhattan = ManhattanState::kNone;  // then labels are not axes
  for (const auto& direction : DominantDirections(lines, camera, 5)) EXPECT_FALSE(direction);
}

TEST_F(AbsoluteRotation, Eq5FindsTheRotationFromFiveDegreesAway) {
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Quaterniond truth = ExpSo3(Normal());
    for (const int count : {2, 3}) {
      const auto pairs = Pairs(truth, count, 0);
      const Eigen::Quaterniond initial = ExpSo3(5 * kRadPerDeg * Normal().normalized()) * truth;
      EXPECT_LT(AngleBetween_rad(OptimizeAbsoluteRotation(pairs, initial), truth), 1e-6);
    }
  }
}

TEST_F(AbsoluteRotation, Eq5StaysAtTheOptimum) {
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Quaterniond truth = ExpSo3(Normal());
    const Eigen::Quaterniond found = OptimizeAbsoluteRotation(Pairs(truth, 3, 0), truth);
    ASSERT_TRUE(found.coeffs().allFinite());
    EXPECT_LT(AngleBetween_rad(found, truth), 1e-7);
  }
  // Exactly there: each angle is zero, and the Jacobian 0 / 0.
  std::vector<DirectionPair> pairs;
  for (int k = 0; k < 3; ++k) pairs.push_back({Eigen::Vector3d::Unit(k), Eigen::Vector3d::Unit(k)});
  const Eigen::Quaterniond found = OptimizeAbsoluteRotation(pairs, Eigen::Quaterniond::Identity());
  EXPECT_EQ(found.coeffs(), Eigen::Quaterniond::Identity().coeffs());
  EXPECT_EQ(OptimizeAbsoluteRotation({}, found).coeffs(), found.coeffs());
}

TEST_F(AbsoluteRotation, Eq5ErrorsAgreeWithTheNoise) {
  // A direction has noise in two directions across it; three orthogonal ones know each rotation
  // twice, so that the covariance is sigma^2 / 2.
  constexpr int kTrials = 400;
  constexpr double kSigma_rad = 0.01;
  double sum = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::Quaterniond truth = ExpSo3(Normal());
    const auto pairs = Pairs(truth, 3, kSigma_rad);
    const Eigen::Quaterniond initial = ExpSo3(3 * kRadPerDeg * Normal().normalized()) * truth;
    const double error_rad = AngleBetween_rad(OptimizeAbsoluteRotation(pairs, initial), truth);
    sum += 2 * error_rad * error_rad / (kSigma_rad * kSigma_rad);
  }
  // Chi-square with three degrees of freedom has 3; this least squares of angles has 3.9.
  EXPECT_GT(sum / kTrials, 2.5);
  EXPECT_LT(sum / kTrials, 4.5);
}

TEST_F(AbsoluteRotation, OneDirectionSaysNothingOfTheTurnAboutIt) {
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Quaterniond truth = ExpSo3(Normal());
    const auto pairs = Pairs(truth, 1, 0);
    const Eigen::Vector3d axis = truth * pairs[0].in_world;
    const Eigen::Vector3d across = axis.cross(Normal()).normalized();
    const Eigen::Quaterniond turned = ExpSo3(0.05 * axis) * truth;
    const Eigen::Quaterniond found =
        OptimizeAbsoluteRotation(pairs, ExpSo3(0.03 * across) * turned);
    EXPECT_LT(AngleBetween_rad(found, turned), 1e-3);
  }
}

}  // namespace
}  // namespace vpslam
