// Ties the map that is begun after a loss to the one before it.
//
// A new map shows nothing of the old one as long as the camera does not come back. But the frames
// since the loss are placed in the new map, walking backwards (late_tracker.h), and the walk may go
// on into the last frames from before the loss: these stand in the old map already. As keyframes of
// the new map they bring a seam, at which the backend joins the two as soon as enough features have
// points in both.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "core/map/map.h"
#include "core/messages/keyframe_proposal.h"
#include "frontend/frame.h"

namespace vpslam {

class LossBridge {
 public:
  /// A frame that was tracked, in order of time.
  void Keep(Frame frame);
  /// The camera is lost: what was kept is the near end. What was kept at an earlier loss is
  /// dropped.
  void Break();
  /// The map that frames were kept of since the loss, or since ever, was given up.
  void ForgetKept() { kept_.clear(); }
  /// The camera was found, or is lost for too long.
  void ForgetNearEnd() { near_end_.clear(); }

  /// The near end crosses over to the new map, whatever happens to the camera meanwhile. Its
  /// frames, in order of time, to be placed there: without matches.
  std::vector<Frame> Cross();
  /// None of them is left to be placed.
  void EndCrossing() { crossing_.clear(); }
  /// Whether the frame is one of these: it was tracked when it came, and has its pose already.
  bool Has(const Frame& frame) const { return Find(frame.seq()) != nullptr; }
  /// Of a frame that crosses, now that it is placed in the new map: where it stands in the old one,
  /// and what it shows of that. None if the old one is gone, or the two have met. The backend needs
  /// points that are common; where both are in view it makes them with the keyframe.
  std::optional<MapSeam> SeamAt(const Map& map, const Frame& placed) const;

 private:
  const Frame* Find(int64_t seq) const;

  std::deque<Frame> kept_, near_end_;
  std::vector<Frame> crossing_;
};

}  // namespace vpslam
