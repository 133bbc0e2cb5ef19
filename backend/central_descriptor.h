// Which of the descriptors of one thing stands for it.
#pragma once

#include <algorithm>
#include <vector>

#include "core/base/thin_out.h"
#include "core/features/features.h"
#include "core/map/map.h"

namespace vpslam {

/// The one with the least median distance to the others. `descriptor_of` takes an Observation;
/// there must be one at least.
template <class DescriptorOf>
Descriptor CentralDescriptor(const std::vector<Observation>& observations,
                             const DescriptorOf& descriptor_of) {
  // More observations hardly change the choice, but cost their square.
  constexpr size_t kMaxCompared = 12;
  std::vector<Descriptor> descriptors;
  const size_t step = ThinOutStep(observations.size(), kMaxCompared);
  for (size_t i = 0; i < observations.size(); i += step) {
    descriptors.push_back(descriptor_of(observations[i]));
  }
  int best_median = 257;
  const Descriptor* best = &descriptors.front();
  std::vector<int> distances(descriptors.size());
  for (const Descriptor& candidate : descriptors) {
    std::transform(descriptors.begin(), descriptors.end(), distances.begin(),
                   [&candidate](const Descriptor& other) { return Distance(candidate, other); });
    const auto middle = distances.begin() + static_cast<int>(distances.size() - 1) / 2;
    std::nth_element(distances.begin(), middle, distances.end());
    if (*middle < best_median) {
      best_median = *middle;
      best = &candidate;
    }
  }
  return *best;
}

}  // namespace vpslam
