#include "player/simulator/trajectory.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/geometry/so3.h"

namespace vpslam::simulator {
namespace {

constexpr HandOptions kStill{0, 0, 0, 0, 0, 0};

TEST(Trajectory, LooksAlongYawAndPitch) {
  const auto waypoint = [](int) { return Waypoint{{1, 2, 1.5}, 0.5, -0.2}; };
  const SE3 pose = Trajectory(waypoint, 1, kStill, 1).WorldFromCam(3.3);
  EXPECT_TRUE(pose.translation.isApprox(Eigen::Vector3d(1, 2, 1.5), 1e-12));
  const Eigen::Vector3d forward(std::cos(0.5) * std::cos(0.2), std::sin(0.5) * std::cos(0.2),
                                -std::sin(0.2));
  EXPECT_TRUE((pose.rotation * Eigen::Vector3d::UnitZ()).isApprox(forward, 1e-12));
  // The camera is upright: its x axis is level, and its y axis points down.
  EXPECT_NEAR((pose.rotation * Eigen::Vector3d::UnitX()).z(), 0, 1e-12);
  EXPECT_LT((pose.rotation * Eigen::Vector3d::UnitY()).z(), -0.9);
}

TEST(Trajectory, FollowsEvenlySpacedWaypointsEvenly) {
  const auto waypoint = [](int k) { return Waypoint{{0.5 * k, 0, 0}, 0.1 * k, 0}; };
  const Trajectory trajectory(waypoint, 0.5, kStill, 1);
  for (const double t : {0.0, 0.4, 1.7, 20.25}) {
    EXPECT_NEAR(trajectory.WorldFromCam(t).translation.x(), t, 1e-12);
  }
}

TEST(Trajectory, HandMovesSmoothlyBySeed) {
  const auto waypoint = [](int) { return Waypoint{}; };
  const Trajectory a(waypoint, 1, {}, 1), b(waypoint, 1, {}, 2);
  constexpr double kStep = 1 / 300.0;
  double moved = 0, turned = 0, largest_jerk = 0;
  for (int i = 2; i < 3000; ++i) {
    const SE3 p0 = a.WorldFromCam((i - 2) * kStep), p1 = a.WorldFromCam((i - 1) * kStep),
              p2 = a.WorldFromCam(i * kStep);
    moved = std::max(moved, p2.translation.norm());
    turned = std::max(turned, LogSo3(p2.rotation * a.WorldFromCam(0).rotation.conjugate()).norm());
    const Eigen::Vector3d change = p2.translation - 2 * p1.translation + p0.translation;
    largest_jerk = std::max(largest_jerk, change.norm() / (kStep * kStep));
  }
  EXPECT_GT(moved, 0.01);
  EXPECT_LT(moved, 0.15);
  EXPECT_GT(turned, 0.02);
  EXPECT_LT(turned, 0.25);
  EXPECT_LT(largest_jerk, 8);  // m/s^2; a jump would show as hundreds
  EXPECT_GT((a.WorldFromCam(1).translation - b.WorldFromCam(1).translation).norm(), 1e-3);
}

}  // namespace
}  // namespace vpslam::simulator
