// The backend as its process sees it: keyframe proposals in, versioned map deltas out.
//
// Owns the map. Knows neither LCM nor time: what it does depends on its inputs and their order
// alone.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "backend/local_ba.h"
#include "backend/mapper_options.h"
#include "core/geometry/camera.h"
#include "core/messages/keyframe_proposal.h"
#include "core/messages/map_delta.h"

namespace vpslam {

class Mapper {
 public:
  Mapper(const Camera& camera, const MapperOptions& options);
  ~Mapper();

  /// Works the keyframe into the map. The last part has `answers` set to the keyframe's id.
  /// `is_urgent`, asked from time to time, cuts the adjustment short; see backend/local_ba.h.
  std::vector<MapDelta> Process(const KeyframeProposal& proposal, const IsUrgent& is_urgent = {});

  /// The whole map, in parts, for a replica that has nothing or missed something.
  std::vector<MapDelta> Snapshot() const;

  int64_t version() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vpslam
