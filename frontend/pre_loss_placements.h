// Ties the map that is begun after a loss to the one from before it.
//
// The new map shows nothing of the old one as long as the camera does not come back. But the frames
// since the loss are placed in the new map, walking backwards (late_tracker.h), and the walk may go
// on into the last frames from before the loss: these stand in the old map already. As keyframes of
// the new map they carry a seam, a candidate for merging the two maps; the backend merges them as
// soon as enough features have points in both.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/map/map.h"
#include "core/messages/keyframe_proposal.h"
#include "frontend/frame.h"

namespace vpslam {

class PreLossPlacements {
 public:
  /// Frames that are to be placed in a new map, with the places that they have in the old one.
  void Add(const std::deque<Frame>& frames);
  /// None of them is left to be placed.
  void Clear() { frames_.clear(); }

  /// Whether the frame is one of these: it was tracked when it came, and its pose is known.
  bool Has(const Frame& frame) const { return Find(frame.seq()) != nullptr; }
  /// Of such a frame, when it is placed in the new map: where it stands in the old one, and which
  /// points of that it shows. None if the old map is gone, or was merged with the new one.
  std::optional<MapSeam> SeamAt(const Map& map, const Frame& placed) const;

 private:
  const Frame* Find(int64_t seq) const;

  std::vector<Frame> frames_;
};

}  // namespace vpslam
