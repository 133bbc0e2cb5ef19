#include "backend/keyframe_insertion.h"

#include <memory>

namespace vpslam {

Keyframe ToKeyframe(const KeyframeProposal& proposal, KeyframeId parent,
                    const Camera::Bounds& bounds) {
  Keyframe keyframe;
  keyframe.id = proposal.id;
  keyframe.map = proposal.map;
  keyframe.frame_seq = proposal.frame_seq;
  keyframe.stamp_us = proposal.stamp_us;
  keyframe.cam_from_world = proposal.cam_from_world;
  keyframe.parent = parent;
  keyframe.points.resize(proposal.features.size());
  keyframe.seen = FrameObservation::Make(proposal.frame_seq, proposal.stamp_us, proposal.features,
                                         bounds, std::make_shared<const LineSet>(proposal.lines));
  return keyframe;
}

}  // namespace vpslam
