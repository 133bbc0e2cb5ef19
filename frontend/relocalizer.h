// Finds a lost frame in the maps, without any idea of where it might be: places that look like it
// (core/map/place_index.h), features against the points there, PnP, and then the local map.
#pragma once

#include <random>
#include <vector>

#include "core/map/place_index.h"
#include "frontend/frame.h"
#include "frontend/frame_tracking.h"
#include "frontend/relocalization_gate.h"
#include "frontend/tracker_options.h"

namespace vpslam {

class Relocalizer {
 public:
  explicit Relocalizer(const TrackerOptions& options)
      : options_(options), index_(options.relocalizer.places) {}

  /// In any map but those in `except` (ascending). Places that `gate` does not allow need
  /// more evidence. On success the frame is placed in the map where it was found; otherwise in
  /// none.
  bool Find(const TrackingContext& context, const std::vector<MapId>& except,
            const RelocalizationGate& gate, std::mt19937_64& rng, Frame* frame);

 private:
  bool TryPlace(const TrackingContext& context, KeyframeId keyframe, const RelocalizationGate& gate,
                std::mt19937_64& rng, Frame* frame) const;
  bool Refine(const TrackingContext& context, const RelocalizationGate& gate, Frame* frame) const;

  TrackerOptions options_;
  PlaceIndex index_;
};

}  // namespace vpslam
