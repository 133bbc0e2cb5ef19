// Who goes first where there are more threads than cores.
#pragma once

#include <unistd.h>

namespace vpslam {

/// By five steps of nice, which is a third of the share of another thread on the same core. On
/// Linux nice is a matter of each thread; threads that exist already keep theirs.
inline void LowerPriorityOfThisThread() {
  constexpr int kSteps = 5;
  [[maybe_unused]] const int now = nice(kSteps);
}

}  // namespace vpslam
