#include "core/geometry/line_triangulation.h"

#include <cmath>
#include <random>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

namespace vpslam {
namespace {

constexpr LineTriangulationOptions kOptions;

LineView Look(const Eigen::Vector3d& center, const Eigen::Vector3d& start,
              const Eigen::Vector3d& end) {
  return {center, (start - center).normalized(), (end - center).normalized()};
}

double DistanceFromLine(const Eigen::Vector3d& x, const Eigen::Vector3d& start,
                        const Eigen::Vector3d& end) {
  return (end - start).normalized().cross(x - start).norm();
}

class LineTriangulation : public testing::Test {
 protected:
  Eigen::Vector3d Vector(double scale) {
    const double x = uniform_(rng_), y = uniform_(rng_), z = uniform_(rng_);
    return scale * Eigen::Vector3d(x, y, z);
  }
  Eigen::Vector3d Noise(double sigma) {
    const double x = normal_(rng_), y = normal_(rng_), z = normal_(rng_);
    return sigma * Eigen::Vector3d(x, y, z);
  }
  /// Each ray off by that.
  LineView LookNoisily(const Eigen::Vector3d& center, const Eigen::Vector3d& start,
                       const Eigen::Vector3d& end, double sigma_rad) {
    LineView view = Look(center, start, end);
    view.start_ray = (view.start_ray + Noise(sigma_rad)).normalized();
    view.end_ray = (view.end_ray + Noise(sigma_rad)).normalized();
    return view;
  }

  std::mt19937 rng_{1};
  std::uniform_real_distribution<double> uniform_{-1, 1};
  std::normal_distribution<double> normal_{0, 1};
};

TEST_F(LineTriangulation, IsExactWithoutNoise) {
  int done = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Vector3d start = Eigen::Vector3d(0, 0, 4) + Vector(1);
    const Eigen::Vector3d end = start + Vector(1);
    const Eigen::Vector3d second = Vector(1.5);
    const LineView a = Look(Vector(0.2), start, end);
    // The other view sees another part of it.
    const LineView b = Look(second, start + 0.3 * (end - start), start + 1.4 * (end - start));
    const auto line = TriangulateLine(a, b, kOptions);
    if (line) {
      ++done;
      EXPECT_NEAR((line->start - start).norm(), 0, 1e-8);
      EXPECT_NEAR((line->end - end).norm(), 0, 1e-8);
    }
    const auto along = TriangulateLineAlong((start - end).normalized(), std::array{a, b}, kOptions);
    if (!along) continue;
    EXPECT_NEAR((along->start - start).norm(), 0, 1e-6) << "whatever the direction's sign";
    EXPECT_NEAR((along->end - end).norm(), 0, 1e-6);
  }
  EXPECT_GT(done, 250);
}

TEST_F(LineTriangulation, ErrorsAgreeWithTheNoise) {
  // A line upright before two cameras side by side: its distance errs by sigma sqrt(2) z^2 / b at
  // either end, when both ends of the second segment decide its plane at the height of the first's.
  const Eigen::Vector3d start(0, -1, 4), end(0, 1, 4), second(0.5, 0, 0);
  constexpr double kSigma_rad = 1e-3;
  double sum = 0, sum2 = 0;
  constexpr int kTrials = 500;
  for (int trial = 0; trial < kTrials; ++trial) {
    const auto line = TriangulateLine(LookNoisily({0, 0, 0}, start, end, kSigma_rad),
                                      LookNoisily(second, start, end, kSigma_rad), kOptions);
    ASSERT_TRUE(line);
    const double range = start.norm();
    const double sigma = std::sqrt(2.0) * kSigma_rad * range * range / second.norm();
    const double error = (line->start.norm() - range) / sigma;
    sum += error;
    sum2 += error * error;
  }
  EXPECT_NEAR(sum / kTrials, 0, 0.2);
  // Chi-square: a standard deviation of 0.06; depth is not range to a few percent.
  EXPECT_NEAR(sum2 / kTrials, 1, 0.25);
}

TEST_F(LineTriangulation, AKnownDirectionMakesItBetter) {
  double free = 0, directed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d start = Eigen::Vector3d(0, -0.5, 5) + Vector(0.5);
    const Eigen::Vector3d end = start + Eigen::Vector3d(0, 1, 0);
    const std::array views = {LookNoisily({0, 0, 0}, start, end, 2e-3),
                              LookNoisily({0.6, 0.1, 0}, start, end, 2e-3)};
    const auto a = TriangulateLine(views[0], views[1], kOptions);
    const auto b = TriangulateLineAlong(Eigen::Vector3d::UnitY(), views, kOptions);
    ASSERT_TRUE(a && b);
    EXPECT_GT((b->end - b->start).normalized().y(), 0.9999);
    free += (a->start - start).squaredNorm() + (a->end - end).squaredNorm();
    directed += (b->start - start).squaredNorm() + (b->end - end).squaredNorm();
  }
  // All four ends tell the depth of the whole line, not two of each end; places across it gain
  // less.
  EXPECT_LT(directed, 0.85 * free);
}

TEST_F(LineTriangulation, MoreViewsMakeADirectedLineBetter) {
  double two = 0, six = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector3d start = Eigen::Vector3d(0, -0.5, 5) + Vector(0.5);
    const Eigen::Vector3d end = start + Eigen::Vector3d(0, 1, 0);
    std::vector<LineView> views;
    for (const double x : {0.0, 0.6, 0.5, 0.55, -0.6, -0.5}) {
      views.push_back(LookNoisily({x, 0, 0}, start, end, 2e-3));
    }
    const auto b = TriangulateLineAlong(Eigen::Vector3d::UnitY(), views, kOptions);
    views.resize(2);
    const auto a = TriangulateLineAlong(Eigen::Vector3d::UnitY(), views, kOptions);
    ASSERT_TRUE(a && b);
    two += DistanceFromLine(start, a->start, a->end);
    six += DistanceFromLine(start, b->start, b->end);
  }
  EXPECT_LT(six, 0.7 * two);
}

TEST_F(LineTriangulation, InTheEpipolarPlaneThereIsNoDepth) {
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d center = Vector(0.1), baseline = Eigen::Vector3d(0.7, 0, 0) + Vector(0.3);
    const Eigen::Vector3d second = center + baseline;
    const Eigen::Vector3d start = Eigen::Vector3d(0, 0, 4) + Vector(1);
    const Eigen::Vector3d end = start + 1.5 * baseline + 0.3 * (start - center);
    const double noise_rad = trial % 2 ? 1e-3 : 0;
    const std::array views = {LookNoisily(center, start, end, noise_rad),
                              LookNoisily(second, start, end, noise_rad)};
    EXPECT_FALSE(TriangulateLine(views[0], views[1], kOptions));
    EXPECT_FALSE(TriangulateLineAlong((end - start).normalized(), views, kOptions));
  }
}

TEST_F(LineTriangulation, NearTheEpipoleThereIsNoDepth) {
  // The camera moves ahead by 1. A line that it moves towards lies in an epipolar plane; one beside
  // it nearly does, and one of which an end lies there.
  const Eigen::Vector3d second(0, 0, 1);
  const auto triangulate = [&](const Eigen::Vector3d& start, const Eigen::Vector3d& end) {
    return TriangulateLine(Look({0, 0, 0}, start, end), Look(second, start, end), kOptions);
  };
  EXPECT_FALSE(triangulate({0, 0, 4}, {1, 0.5, 4}));
  EXPECT_FALSE(triangulate({0.2, 0.1, 4}, {1, 0.5, 4}));
  EXPECT_FALSE(triangulate({-0.5, 0.05, 4}, {0.5, 0.05, 4}));
  EXPECT_TRUE(triangulate({-0.5, 0.5, 4}, {0.5, 0.5, 4}));
}

TEST_F(LineTriangulation, PureRotationIsRefused) {
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::Vector3d start = Eigen::Vector3d(0, 0, 4) + Vector(1), end = start + Vector(1);
    const double noise_rad = trial % 2 ? 2e-3 : 0;
    const std::array views = {LookNoisily({0, 0, 0}, start, end, noise_rad),
                              LookNoisily({0, 0, 0}, start, end, noise_rad)};
    EXPECT_FALSE(TriangulateLine(views[0], views[1], kOptions));
    EXPECT_FALSE(TriangulateLineAlong((end - start).normalized(), views, kOptions));
  }
}

TEST_F(LineTriangulation, TheAngleBetweenPlanesDecides) {
  const Eigen::Vector3d start(0, -1, 4), end(0, 1, 4);
  for (const double factor : {0.8, 0.95, 1.05, 1.3}) {
    // Both planes are upright; seen from the line, the cameras are that angle apart. A ray to the
    // end is at a lesser angle to the other plane, by the cosine of its slope.
    const double angle_rad = factor * kOptions.min_ray_plane_angle_rad;
    const Eigen::Vector3d second(4 * std::tan(angle_rad), 0, 0);
    const std::array views = {Look({0, 0, 0}, start, end), Look(second, start, end)};
    EXPECT_EQ(TriangulateLineAlong(Eigen::Vector3d::UnitY(), views, kOptions).has_value(),
              factor > 1)
        << factor;
    const Eigen::Vector3d wider(4 * std::tan(std::asin(std::sin(angle_rad) * start.norm() / 4)), 0,
                                0);
    EXPECT_EQ(TriangulateLine(views[0], Look(wider, start, end), kOptions).has_value(), factor > 1)
        << factor;
  }
}

TEST_F(LineTriangulation, BehindTheCameraIsRefused) {
  // Planes that meet behind camera a: the second segment lies on the wrong side.
  const Eigen::Vector3d start(0, -1, 4), end(0, 1, 4);
  const LineView a = Look({0, 0, 0}, start, end);
  LineView b = Look({0.5, 0, 0}, {1.0, -1, 4}, {1.0, 1, 4});
  EXPECT_FALSE(TriangulateLine(a, b, kOptions));
  EXPECT_FALSE(TriangulateLineAlong(Eigen::Vector3d::UnitY(), std::array{a, b}, kOptions));
}

TEST_F(LineTriangulation, AWrongDirectionIsNoNumber) {
  const Eigen::Vector3d start(0, -1, 4), end(0, 1, 4);
  const std::array views = {Look({0, 0, 0}, start, end), Look({0.5, 0, 0}, start, end)};
  // Across both planes, and along a ray.
  for (const Eigen::Vector3d& direction :
       {Eigen::Vector3d(views[0].Normal()), Eigen::Vector3d(views[0].start_ray)}) {
    const auto line = TriangulateLineAlong(direction, views, kOptions);
    EXPECT_TRUE(!line || (line->start.allFinite() && line->end.allFinite()));
  }
  EXPECT_FALSE(TriangulateLineAlong(views[0].start_ray, views, kOptions));
  EXPECT_FALSE(TriangulateLineAlong(Eigen::Vector3d::UnitY(), std::span(views).first(1), kOptions));
  EXPECT_FALSE(TriangulateLineAlong(Eigen::Vector3d::UnitY(), {}, kOptions));
}

TEST_F(LineTriangulation, NearestOnLineIsNearest) {
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Vector3d point = Vector(3), direction = Vector(1).normalized();
    const Eigen::Vector3d center = Vector(3), ray = Vector(1).normalized();
    const auto s = NearestOnLine(point, direction, center, ray);
    ASSERT_TRUE(s);
    const auto distance = [&](double at) {
      return ray.cross(point + at * direction - center).norm();
    };
    EXPECT_LE(distance(*s), distance(*s + 1e-3));
    EXPECT_LE(distance(*s), distance(*s - 1e-3));
  }
  EXPECT_FALSE(NearestOnLine({0, 0, 4}, {0, 0, 1}, {0, 0, 0}, {0, 0, 1}));
  EXPECT_FALSE(NearestOnLine({0, 0, 4}, {0, 0, 1}, {0, 0, 0}, {0, 0, -1}));
}

}  // namespace
}  // namespace vpslam
