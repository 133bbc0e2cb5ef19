// Wall-clock time of stages, for the tables of a run; nothing that is computed depends on it.
#pragma once

#include <chrono>
#include <limits>

namespace vpslam {

/// Milliseconds of a stage that did not run.
inline constexpr double kNotRun = std::numeric_limits<double>::quiet_NaN();

class Stopwatch {
 public:
  /// Milliseconds since the last call, or since construction.
  double Lap_ms() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace vpslam
