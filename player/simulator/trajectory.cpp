#include "player/simulator/trajectory.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "core/geometry/so3.h"
#include "player/simulator/random.h"

namespace vpslam::simulator {
namespace {

constexpr int kWaves = 5;

double Sum(const std::vector<SmoothNoise>& noises, double t_s) {
  double sum = 0;
  for (const SmoothNoise& noise : noises) sum += noise(t_s);
  return sum;
}

}  // namespace

SmoothNoise::SmoothNoise(double low_hz, double high_hz, double amplitude, uint64_t seed) {
  Random random(seed);
  for (int i = 0; i < kWaves; ++i) {
    const double hz = low_hz + (high_hz - low_hz) * (i + random.Uniform()) / kWaves;
    waves_.push_back({2 * std::numbers::pi * hz, random.Uniform(0, 2 * std::numbers::pi),
                      amplitude * std::sqrt(2.0 / kWaves)});
  }
}

double SmoothNoise::operator()(double t_s) const {
  double sum = 0;
  for (const Wave& w : waves_) sum += w.amplitude * std::sin(w.omega * t_s + w.phase);
  return sum;
}

Trajectory::Trajectory(std::function<Waypoint(int)> waypoint, double knot_s,
                       const HandOptions& hand, uint64_t seed)
    : waypoint_(std::move(waypoint)), knot_s_(knot_s) {
  for (uint64_t axis = 0; axis < 3; ++axis) {
    std::vector<SmoothNoise> shift = {
        {0.3, 1.2, hand.sway_m, Hash({seed, axis, 0})},
        {3, 9, hand.tremor_m, Hash({seed, axis, 1})},
    };
    if (axis == 2) shift.push_back({1.6, 2.1, hand.step_m, Hash({seed, axis, 2})});
    shift_.push_back(std::move(shift));
    turn_.push_back({{0.3, 1.4, hand.sway_rad, Hash({seed, axis, 3})},
                     {1.5, 5, hand.shake_rad, Hash({seed, axis, 4})},
                     {5, 11, hand.tremor_rad, Hash({seed, axis, 5})}});
  }
}

SE3 Trajectory::WorldFromCam(double t_s) const {
  const double knots = t_s / knot_s_;
  const int k = static_cast<int>(std::floor(knots));
  const double f = knots - k;
  const double weights[4] = {(1 - f) * (1 - f) * (1 - f) / 6, (3 * f * f * f - 6 * f * f + 4) / 6,
                             (-3 * f * f * f + 3 * f * f + 3 * f + 1) / 6, f * f * f / 6};
  Waypoint mean;
  for (int i = 0; i < 4; ++i) {
    const Waypoint w = waypoint_(k - 1 + i);
    mean.position_m += weights[i] * w.position_m;
    mean.yaw_rad += weights[i] * w.yaw_rad;
    mean.pitch_rad += weights[i] * w.pitch_rad;
  }
  const Eigen::Vector3d forward(std::cos(mean.yaw_rad) * std::cos(mean.pitch_rad),
                                std::sin(mean.yaw_rad) * std::cos(mean.pitch_rad),
                                std::sin(mean.pitch_rad));
  const Eigen::Vector3d right(std::sin(mean.yaw_rad), -std::cos(mean.yaw_rad), 0);
  Eigen::Matrix3d world_from_aim;
  world_from_aim << right, forward.cross(right), forward;
  const Eigen::Vector3d shift(Sum(shift_[0], t_s), Sum(shift_[1], t_s), Sum(shift_[2], t_s));
  const Eigen::Vector3d turn(Sum(turn_[0], t_s), Sum(turn_[1], t_s), Sum(turn_[2], t_s));
  return SE3(Eigen::Quaterniond(world_from_aim) * ExpSo3(turn), mean.position_m + shift);
}

}  // namespace vpslam::simulator
