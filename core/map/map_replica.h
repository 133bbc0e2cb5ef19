// A map that follows its owner's by deltas (core/messages/map_delta.h). It has no features.
#pragma once

#include "core/map/map.h"
#include "core/messages/map_delta.h"

namespace vpslam {

class MapReplica : public Map {
 public:
  /// False if the delta does not continue the version at hand, and nothing is done. False also if
  /// it speaks of what this replica does not know, after which no delta fits: ask for a snapshot.
  bool Apply(const MapDelta& delta);

 private:
  void Take(const PointAppearance& appearance);
  void Take(const PointGeometry& geometry);
  void Take(const LineState& state);
  void Take(const KeyframeState& state);
  void Take(const MapManhattan& manhattan);
  template <class Id>
  void Take(const Tombstone<Id>& tombstone);
  template <class Id>
  void TakeObservations(KeyframeId keyframe, const std::vector<FeatureObservation<Id>>& now);
};

}  // namespace vpslam
