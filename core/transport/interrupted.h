// How a process' loop ends early: one exception, from wherever the loop waits to where it began.
#pragma once

#include <exception>

namespace vpslam {

/// The bus was interrupted, which means that the process is to stop. No error: the loop catches it.
class Interrupted : public std::exception {
 public:
  const char* what() const noexcept override { return "interrupted"; }
};

/// Around calls that return false when the bus was interrupted (Bus::WaitFor without a limit of
/// time, StreamWriter::Send, ...), where the caller has nothing to do about it. Throws Interrupted.
inline void UnlessInterrupted(bool went_on) {
  if (!went_on) throw Interrupted();
}

}  // namespace vpslam
