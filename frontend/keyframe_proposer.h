// Gives ids to keyframes and maps, and keeps what the backend is told with keyframes.
#pragma once

#include <cstdint>

#include "core/map/map.h"
#include "core/messages/keyframe_proposal.h"
#include "frontend/frame.h"
#include "frontend/keyframe_policy.h"

namespace vpslam {

class KeyframeProposer {
 public:
  /// `map`: the replica; must outlive it.
  explicit KeyframeProposer(const Map& map) : map_(map) {}

  /// Another frontend gave ids of this session or a later one, and none was given here yet.
  bool HasToTakeOver() const;
  /// Gives ids of a new session from now on.
  void TakeOver() { session_ = map_.latest_session() + 1; }

  MapId NewMap() { return MapId(session_, next_map_++); }
  /// Makes a placed frame a keyframe of its map.
  KeyframeProposal Propose(Frame* frame);
  /// Tells the backend with this proposal which map is to be erased, if there is one.
  void AddDiscardedMap(KeyframeProposal* proposal);
  void DiscardMap(MapId map) { discarded_map_ = map; }
  /// A map that is to be erased, and of which the backend was not told yet; invalid for none.
  MapId discarded_map() const { return discarded_map_; }

  /// A frame was tracked, or should have been.
  void CountFrame() { ++earlier_.frames_since; }
  void RestartCount() { earlier_.frames_since = 0; }
  void SetUnanswered(int keyframes) { earlier_.unanswered = keyframes; }
  const EarlierKeyframes& earlier() const { return earlier_; }

 private:
  const Map& map_;
  int32_t session_ = 0;
  int64_t next_map_ = 0, next_keyframe_ = 0;
  MapId discarded_map_;
  EarlierKeyframes earlier_;
};

}  // namespace vpslam
