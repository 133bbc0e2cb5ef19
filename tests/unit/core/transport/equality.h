// Field by field, bit by bit (so NaN equals NaN): what a round trip must preserve.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "core/transport/validate.h"

namespace vpslam {  // where argument-dependent look-up finds them

inline bool Same(double a, double b) {
  return std::bit_cast<uint64_t>(a) == std::bit_cast<uint64_t>(b);
}
inline bool Same(const Header& a, const Header& b) {
  return a.session == b.session && a.seq == b.seq && a.oldest_seq == b.oldest_seq &&
         a.stamp_us == b.stamp_us && a.last == b.last;
}
inline bool Same(const SE3& a, const SE3& b) {
  return a.rotation.coeffs() == b.rotation.coeffs() && a.translation == b.translation;
}
template <class T>
bool Same(const std::vector<T>& a, const std::vector<T>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!Same(a[i], b[i])) return false;
  }
  return true;
}
inline bool Same(const Camera& a, const Camera& b) {
  return a.width == b.width && a.height == b.height && a.fps == b.fps && a.fx == b.fx &&
         a.fy == b.fy && a.cx == b.cx && a.cy == b.cy && a.k1 == b.k1 && a.k2 == b.k2 &&
         a.k3 == b.k3 && a.p1 == b.p1 && a.p2 == b.p2;
}
inline bool Same(const ImageMessage& a, const ImageMessage& b) {
  return a.frame_seq == b.frame_seq && a.stamp_us == b.stamp_us &&
         a.published_us == b.published_us && Same(a.decode_ms, b.decode_ms) && a.width == b.width &&
         a.height == b.height && a.segment == b.segment && a.slot == b.slot &&
         a.generation == b.generation && a.bytes == b.bytes;
}
inline bool Same(const Keypoint& a, const Keypoint& b) {
  return a.x_px == b.x_px && a.y_px == b.y_px && a.angle_rad == b.angle_rad &&
         a.response == b.response && a.octave == b.octave &&
         a.roundness_per_10000 == b.roundness_per_10000 && a.edge_mrad == b.edge_mrad;
}
inline bool Same(const Features& a, const Features& b) {
  return Same(a.keypoints, b.keypoints) && a.descriptors == b.descriptors;
}
inline bool Same(const LineSegment& a, const LineSegment& b) {
  return a.start_px == b.start_px && a.end_px == b.end_px && a.sigma_px == b.sigma_px &&
         a.descriptor == b.descriptor && a.has_descriptor == b.has_descriptor && a.label == b.label;
}
inline bool Same(const VanishingPoint& a, const VanishingPoint& b) {
  return a.direction_in_cam == b.direction_in_cam && a.covariance_rad2 == b.covariance_rad2 &&
         a.support == b.support;
}
inline bool Same(const LineSet& a, const LineSet& b) {
  return a.frame_seq == b.frame_seq && a.stamp_us == b.stamp_us && Same(a.lines, b.lines) &&
         Same(a.vanishing_points, b.vanishing_points) && a.manhattan == b.manhattan &&
         a.cam_from_manhattan.coeffs() == b.cam_from_manhattan.coeffs() &&
         a.covariance_rad2 == b.covariance_rad2 && a.lines_ms == b.lines_ms &&
         a.descriptors_ms == b.descriptors_ms && a.vps_ms == b.vps_ms;
}
inline bool Same(const FrameFeatures& a, const FrameFeatures& b) {
  return a.frame_seq == b.frame_seq && a.stamp_us == b.stamp_us &&
         a.published_us == b.published_us && Same(a.decode_ms, b.decode_ms) &&
         Same(a.features_ms, b.features_ms) && Same(a.features, b.features) &&
         !a.lines == !b.lines && (!a.lines || Same(*a.lines, *b.lines));
}
inline bool Same(const RunDescription& a, const RunDescription& b) {
  return a.seed == b.seed && a.commit == b.commit && a.options == b.options;
}
inline bool Same(const TrackingTimes& a, const TrackingTimes& b) {
  return Same(a.decode_ms, b.decode_ms) && Same(a.transport_ms, b.transport_ms) &&
         Same(a.features_ms, b.features_ms) && Same(a.lines_ms, b.lines_ms) &&
         Same(a.vps_ms, b.vps_ms) && Same(a.wait_for_lines_ms, b.wait_for_lines_ms) &&
         Same(a.initial_pose_ms, b.initial_pose_ms) && Same(a.rotation_ms, b.rotation_ms) &&
         Same(a.translation_ms, b.translation_ms) && Same(a.local_map_ms, b.local_map_ms) &&
         Same(a.total_ms, b.total_ms);
}
inline bool Same(const FramePose& a, const FramePose& b) {
  return a.frame_seq == b.frame_seq && a.stamp_us == b.stamp_us &&
         a.image_published_us == b.image_published_us && a.state == b.state && a.live == b.live &&
         a.map == b.map && Same(a.cam_from_world, b.cam_from_world) && a.reference == b.reference &&
         Same(a.cam_from_reference, b.cam_from_reference) && a.covariance == b.covariance &&
         a.inliers == b.inliers && a.matches == b.matches && a.keyframe == b.keyframe &&
         Same(a.times, b.times);
}
inline bool Same(const Truth& a, const Truth& b) {
  return a.frame_seq == b.frame_seq && a.stamp_us == b.stamp_us &&
         Same(a.world_from_cam, b.world_from_cam);
}
inline bool Same(const PointSighting& a, const PointSighting& b) {
  return a.point == b.point && a.visible == b.visible && a.found == b.found;
}
inline bool Same(const InitialPoint& a, const InitialPoint& b) {
  return a.feature_in_first == b.feature_in_first && a.feature_in_second == b.feature_in_second &&
         a.position_in_world == b.position_in_world;
}
template <class Id>
bool Same(const FeatureObservation<Id>& a, const FeatureObservation<Id>& b) {
  return a.feature == b.feature && a.landmark == b.landmark;
}
inline bool Same(const KeyframeProposal& a, const KeyframeProposal& b) {
  return a.id == b.id && a.role == b.role && a.map == b.map && a.discarded_map == b.discarded_map &&
         a.frame_seq == b.frame_seq && a.stamp_us == b.stamp_us &&
         Same(a.cam_from_world, b.cam_from_world) && a.reference == b.reference &&
         Same(a.features, b.features) && a.points == b.points && Same(a.sightings, b.sightings) &&
         Same(a.initial_points, b.initial_points) && Same(a.lines, b.lines) &&
         a.map_lines == b.map_lines && a.seam.map == b.seam.map &&
         Same(a.seam.cam_from_world, b.seam.cam_from_world) && Same(a.seam.points, b.seam.points);
}
inline bool Same(const KeyframeState& a, const KeyframeState& b) {
  return a.id == b.id && a.map == b.map && a.frame_seq == b.frame_seq && a.stamp_us == b.stamp_us &&
         a.culled == b.culled && Same(a.cam_from_world, b.cam_from_world) && a.parent == b.parent &&
         Same(a.cam_from_parent, b.cam_from_parent) && Same(a.points, b.points) &&
         Same(a.lines, b.lines) && a.unit == b.unit;
}
inline bool Same(const PointGeometry& a, const PointGeometry& b) {
  return a.id == b.id && a.position == b.position && a.normal == b.normal &&
         a.max_distance == b.max_distance;
}
inline bool Same(const PointAppearance& a, const PointAppearance& b) {
  return a.id == b.id && a.map == b.map && a.reference == b.reference &&
         a.descriptor == b.descriptor;
}
template <class Id>
bool Same(const Tombstone<Id>& a, const Tombstone<Id>& b) {
  return a.id == b.id && a.replacement == b.replacement;
}
inline bool Same(const LineState& a, const LineState& b) {
  return a.id == b.id && a.map == b.map && a.reference == b.reference && a.start == b.start &&
         a.end == b.end && a.descriptor == b.descriptor && a.axis == b.axis;
}
inline bool Same(const MapManhattan& a, const MapManhattan& b) {
  const auto& qa = a.world_from_manhattan;
  const auto& qb = b.world_from_manhattan;
  return a.map == b.map && qa.has_value() == qb.has_value() &&
         (!qa || qa->coeffs() == qb->coeffs());
}
inline bool Same(const MapMerger& a, const MapMerger& b) {
  return a.from == b.from && a.into == b.into;
}
inline bool Same(const MapDelta& a, const MapDelta& b) {
  return a.base_version == b.base_version && a.version == b.version && a.snapshot == b.snapshot &&
         a.answers == b.answers && Same(a.times.insertion_ms, b.times.insertion_ms) &&
         Same(a.times.feature_culling_ms, b.times.feature_culling_ms) &&
         Same(a.times.feature_creation_ms, b.times.feature_creation_ms) &&
         Same(a.times.keyframe_culling_ms, b.times.keyframe_culling_ms) &&
         Same(a.times.local_ba_ms, b.times.local_ba_ms) &&
         Same(a.times.total_ms, b.times.total_ms) && a.erased_maps == b.erased_maps &&
         Same(a.merged_maps, b.merged_maps) && Same(a.keyframes, b.keyframes) &&
         Same(a.appearances, b.appearances) && Same(a.geometries, b.geometries) &&
         Same(a.tombstones, b.tombstones) && Same(a.lines, b.lines) &&
         Same(a.line_tombstones, b.line_tombstones) && Same(a.manhattan_frames, b.manhattan_frames);
}
inline bool Same(const MapRequest& a, const MapRequest& b) {
  return a.process == b.process && a.map_version == b.map_version;
}
inline bool Same(const LinesRequest& a, const LinesRequest& b) {
  return a.frame_seq == b.frame_seq && a.image_session == b.image_session &&
         a.detector == b.detector;
}
inline bool Same(const Ack& a, const Ack& b) {
  return a.stream == b.stream && a.stream_session == b.stream_session && a.consumer == b.consumer &&
         a.received == b.received && a.done == b.done;
}
inline bool Same(const Command& a, const Command& b) {
  return a.target == b.target && a.action == b.action && a.value == b.value;
}
inline bool Same(const ProcessStatus& a, const ProcessStatus& b) {
  return a.process == b.process && a.pid == b.pid && a.protocol_version == b.protocol_version &&
         a.state == b.state && a.rate_hz == b.rate_hz && a.processed == b.processed &&
         a.queued == b.queued && a.dropped == b.dropped && a.gaps == b.gaps &&
         a.rejected == b.rejected && a.resent == b.resent && a.cpu_s == b.cpu_s &&
         a.rss_peak_mb == b.rss_peak_mb && a.message == b.message;
}
inline bool Same(const Preview& a, const Preview& b) {
  return a.frame_seq == b.frame_seq && a.stamp_us == b.stamp_us && a.jpeg == b.jpeg;
}

}  // namespace vpslam
