// What fusing points and fusing lines have in common.
#pragma once

#include <algorithm>
#include <vector>

#include "core/map/owned_map.h"

namespace vpslam {

template <class Landmark>
bool IsObservedBy(const Landmark& landmark, KeyframeId keyframe) {
  return std::any_of(landmark.observations.begin(), landmark.observations.end(),
                     [keyframe](const Observation& o) { return o.keyframe == keyframe; });
}

/// The feature or segment `index` of the keyframe shows the landmark `id`: it observes it or, where
/// it has one already (`observed` lists what the keyframe observes), the two are fused, and the
/// better known stays. Returns what stays.
template <class Id>
Id ObserveOrFuse(KeyframeId keyframe, const std::vector<Id>& observed, int index, Id id,
                 OwnedMap* map) {
  const Id other_id = index < static_cast<int>(observed.size()) ? observed[index] : Id();
  const auto* other = map->Find(other_id);
  if (!other) {
    map->Observe(keyframe, index, id);
    return id;
  }
  const bool other_stays = other->observations.size() > map->Find(id)->observations.size();
  map->Fuse(other_stays ? id : other_id, other_stays ? other_id : id);
  return other_stays ? other_id : id;
}

}  // namespace vpslam
