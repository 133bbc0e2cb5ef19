// Bit by bit (so NaN equals NaN): what a round trip must preserve.
#pragma once

#include "core/transport/wire_writer.h"

namespace vpslam::test {

/// WireWriter leaves nothing out: see AgreementWithLcm in codec_test.cpp.
template <class T>
bool Same(const T& a, const T& b) {
  WireWriter of_a, of_b;
  Description<T>::Visit(of_a, a);
  Description<T>::Visit(of_b, b);
  return of_a.Take() == of_b.Take();
}

}  // namespace vpslam::test
