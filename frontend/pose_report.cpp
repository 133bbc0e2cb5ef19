#include "frontend/pose_report.h"

namespace vpslam {

FramePose ReportUnplaced(const Frame& frame, TrackingState state, MapId map) {
  FramePose pose;
  pose.frame_seq = frame.seen->frame_seq;
  pose.stamp_us = frame.seen->stamp_us;
  pose.image_published_us = frame.published_us;
  pose.state = state;
  pose.map = map;
  pose.times = frame.times;
  return pose;
}

FramePose ReportPlaced(const Frame& frame) {
  const Placement& placement = frame.placement;
  FramePose pose = ReportUnplaced(frame, TrackingState::kTracking, placement.map());
  pose.cam_from_world = placement.cam_from_world;
  pose.reference = placement.reference;
  pose.cam_from_reference = placement.cam_from_reference;
  pose.covariance = placement.covariance;
  pose.inliers = placement.inliers;
  pose.matches = placement.num_matches;
  return pose;
}

FramePose ReportPlacedLate(const Frame& frame) {
  FramePose pose = ReportPlaced(frame);
  pose.live = false;
  return pose;
}

}  // namespace vpslam
