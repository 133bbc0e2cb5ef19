#include "frontend/keyframe_proposer.h"

#include <utility>

namespace vpslam {

bool KeyframeProposer::HasToTakeOver() const {
  return next_keyframe_ == 0 && map_.latest_session() >= session_;
}

KeyframeProposal KeyframeProposer::Propose(Frame* frame) {
  KeyframeProposal proposal = MakeProposal(*frame, KeyframeId(session_, next_keyframe_++));
  // The backend forgets what became of old landmarks once all know of it.
  proposal.map_version = map_.version();
  frame->placement.BecomeKeyframe(proposal.id);
  return proposal;
}

void KeyframeProposer::AddDiscardedMap(KeyframeProposal* proposal) {
  proposal->discarded_map = std::exchange(discarded_map_, MapId());
}

}  // namespace vpslam
