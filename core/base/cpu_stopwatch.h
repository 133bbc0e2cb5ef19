// CPU time of the calling thread: what a stage costs, whatever else runs on the machine.
#pragma once

#include <ctime>

namespace vpslam {

class CpuStopwatch {
 public:
  /// Milliseconds of this thread's CPU time since the last call, or since construction.
  double Lap_ms() {
    const double now = Now_ms(), ms = now - last_ms_;
    last_ms_ = now;
    return ms;
  }

 private:
  static double Now_ms() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
  }
  double last_ms_ = Now_ms();
};

}  // namespace vpslam
