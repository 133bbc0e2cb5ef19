// Random samples that are the same on every platform: the distributions of <random> are free to
// differ between standard libraries, the generators are not.
#pragma once

#include <array>
#include <cstdint>
#include <random>

namespace vpslam {

/// An index in [0, size); its bias is below size / 2^64.
inline int RandomIndex(int size, std::mt19937_64& rng) {
  return static_cast<int>(rng() % static_cast<uint64_t>(size));
}

/// N distinct indices in [0, size); size must be at least N.
template <int N>
std::array<int, N> RandomSample(int size, std::mt19937_64& rng) {
  std::array<int, N> sample;
  for (int i = 0; i < N; ++i) {
    bool repeated = true;
    while (repeated) {
      sample[i] = RandomIndex(size, rng);
      repeated = false;
      for (int j = 0; j < i; ++j) repeated |= sample[j] == sample[i];
    }
  }
  return sample;
}

}  // namespace vpslam
