// Finds a lost frame in the maps, without any idea of where it might be: places that look like it
// (core/map/place_index.h), features against the points there, PnP, and then the local map.
#pragma once

#include <optional>
#include <random>
#include <vector>

#include "core/map/place_index.h"
#include "frontend/frame.h"
#include "frontend/frame_tracking.h"
#include "frontend/tracker_options.h"
#include "frontend/whereabouts.h"

namespace vpslam {

class Relocalizer {
 public:
  explicit Relocalizer(const TrackerOptions& options)
      : options_(options), index_(options.relocalizer.places) {}

  /// In any map but those in `except` (ascending). Places that `whereabouts` don't allow need more
  /// evidence. Returns the map in which the frame was found; the frame then has its pose, and
  /// matches with points of that map only, whatever it was matched with before. On failure it has
  /// no matches.
  std::optional<MapId> Find(const TrackingContext& context, const std::vector<MapId>& except,
                            const Whereabouts& whereabouts, std::mt19937_64& rng, Frame* frame);

 private:
  bool TryPlace(const TrackingContext& context, KeyframeId keyframe, const Whereabouts& whereabouts,
                std::mt19937_64& rng, Frame* frame) const;
  bool Refine(const TrackingContext& context, MapId map, const Whereabouts& whereabouts,
              Frame* frame) const;

  TrackerOptions options_;
  PlaceIndex index_;
};

}  // namespace vpslam
