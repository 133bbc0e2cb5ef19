// Ties the map that is begun after a loss to the one before it.
//
// A new map shows nothing of the old one as long as the camera does not come back. But the frames
// since the loss are placed in the new map, walking backwards (late_tracker.h), and the walk may go
// on into the last frames from before the loss: these stand in the old map already. The one of them
// that shows most points of both makes a seam, at which the backend joins the two.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>
#include <vector>

#include "core/map/map.h"
#include "core/messages/keyframe_proposal.h"
#include "frontend/frame.h"
#include "frontend/tracker_options.h"

namespace vpslam {

class LossBridge {
 public:
  explicit LossBridge(const SeamOptions& options) : options_(options) {}

  /// A frame that was tracked, in order of time.
  void Keep(Frame frame);
  /// The camera is lost: what was kept is the near end. What was kept at an earlier loss is
  /// dropped.
  void Break();
  /// The map that frames were kept of since the loss, or since ever, was given up.
  void ForgetKept() { kept_.clear(); }
  /// The camera was found, or is lost for too long.
  void ForgetNearEnd();

  /// Of the near end, in order of time, to be placed in the new map: without matches.
  std::vector<Frame> NearEnd() const;
  /// A frame that was placed late. Returns whether it is one of the near end: it was tracked when
  /// it came, and has its pose already.
  bool Offer(const Map& map, const Frame& placed);
  /// The best that was offered, with matches and pose in the new map as it is now, once.
  std::optional<std::pair<Frame, MapSeam>> Take(const Map& map);

 private:
  SeamOptions options_;
  std::deque<Frame> kept_, near_end_;
  std::optional<Frame> best_;
  int best_common_ = 0;
};

}  // namespace vpslam
