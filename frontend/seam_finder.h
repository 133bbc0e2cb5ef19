// Finds candidates for merging two maps ("seams"): frames that are tracked in one map and show
// another one as well.
#pragma once

#include <optional>
#include <random>

#include "core/messages/keyframe_proposal.h"
#include "frontend/relocalizer.h"

namespace vpslam {

class SeamFinder {
 public:
  explicit SeamFinder(const SeamOptions& options) : options_(options) {}

  /// Looks, at its turn, for a tracked frame in all maps but its own and `discarded`.
  /// A seam has at least min_common features that show points of both maps.
  std::optional<MapSeam> Look(const TrackingContext& context, const Frame& frame, MapId discarded,
                              std::mt19937_64& rng, Relocalizer* relocalizer);

 private:
  SeamOptions options_;
  int frames_to_wait_ = 0;
};

}  // namespace vpslam
