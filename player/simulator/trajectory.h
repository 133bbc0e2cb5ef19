// Where a hand-held camera is at any moment: a uniform cubic B-spline through way-points (smooth
// up to acceleration), plus the sway of a walking body and the tremor of a hand.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/se3.h"

namespace vpslam::simulator {

/// What the path aims at. The camera looks along yaw (about z, 0 is +x) and pitch (up is positive);
/// yaw is continuous from way-point to way-point: no jump by a turn.
struct Waypoint {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  double yaw_rad = 0;
  double pitch_rad = 0;
};

/// Sums of sines with random frequency and phase: smooth, and known at any moment without a state.
class SmoothNoise {
 public:
  /// RMS `amplitude`, frequencies spread evenly over [low_hz, high_hz].
  SmoothNoise(double low_hz, double high_hz, double amplitude, uint64_t seed);
  double operator()(double t_s) const;

 private:
  struct Wave {
    double omega, phase, amplitude;
  };
  std::vector<Wave> waves_;
};

struct HandOptions {
  double sway_m = 0.012;       ///< RMS of each axis, 0.3 to 1.2 Hz
  double step_m = 0.006;       ///< RMS of the vertical bob of steps, 1.6 to 2.1 Hz
  double tremor_m = 0.0006;    ///< RMS of each axis, 3 to 9 Hz
  double sway_rad = 0.018;     ///< RMS of each axis, 0.3 to 1.4 Hz
  double shake_rad = 0.003;    ///< RMS of each axis, 1.5 to 5 Hz
  double tremor_rad = 0.0005;  ///< RMS of each axis, 5 to 11 Hz
};

class Trajectory {
 public:
  /// `waypoint(k)` belongs to the time k * knot_s, for any integer k from -1 on.
  Trajectory(std::function<Waypoint(int)> waypoint, double knot_s, const HandOptions& hand,
             uint64_t seed);

  SE3 WorldFromCam(double t_s) const;

 private:
  std::function<Waypoint(int)> waypoint_;
  double knot_s_;
  std::vector<std::vector<SmoothNoise>> shift_;  // per world axis
  std::vector<std::vector<SmoothNoise>> turn_;   // per camera axis
};

}  // namespace vpslam::simulator
