// Messages about one frame: camera, image, features, lines, pose, truth, preview.
#include "core/transport/convert_parts.h"

namespace vpslam {

camera_t ToWire(const Camera& camera) {
  camera_t wire{};
  wire.width = camera.width;
  wire.height = camera.height;
  wire.fps = camera.fps;
  wire.fx = camera.fx;
  wire.fy = camera.fy;
  wire.cx = camera.cx;
  wire.cy = camera.cy;
  wire.k1 = camera.k1;
  wire.k2 = camera.k2;
  wire.k3 = camera.k3;
  wire.p1 = camera.p1;
  wire.p2 = camera.p2;
  return wire;
}

std::optional<Camera> FromWire(const camera_t& wire, std::string* why) {
  Camera camera;
  camera.width = wire.width;
  camera.height = wire.height;
  camera.fps = wire.fps;
  camera.fx = wire.fx;
  camera.fy = wire.fy;
  camera.cx = wire.cx;
  camera.cy = wire.cy;
  camera.k1 = wire.k1;
  camera.k2 = wire.k2;
  camera.k3 = wire.k3;
  camera.p1 = wire.p1;
  camera.p2 = wire.p2;
  return Checked(camera, why);
}

image_t ToWire(const ImageMessage& image) {
  image_t wire{};
  wire.num_bytes = static_cast<int32_t>(image.bytes.size());
  wire.frame_seq = image.frame_seq;
  wire.stamp_us = image.stamp_us;
  wire.published_us = image.published_us;
  wire.decode_ms = image.decode_ms;
  wire.width = image.width;
  wire.height = image.height;
  wire.encoding = image_t::GRAY8;
  wire.segment = image.segment;
  wire.slot = image.slot;
  wire.generation = image.generation;
  wire.bytes = image.bytes;
  return wire;
}

std::optional<ImageMessage> FromWire(const image_t& wire, std::string* why) {
  if (wire.encoding != image_t::GRAY8) {
    *why = "unknown encoding";
    return std::nullopt;
  }
  ImageMessage image;
  image.frame_seq = wire.frame_seq;
  image.stamp_us = wire.stamp_us;
  image.published_us = wire.published_us;
  image.decode_ms = wire.decode_ms;
  image.width = wire.width;
  image.height = wire.height;
  image.segment = wire.segment;
  image.slot = wire.slot;
  image.generation = wire.generation;
  image.bytes = wire.bytes;
  return Checked(std::move(image), why);
}

features_t ToWire(const FrameFeatures& features) {
  features_t wire{};
  wire.num_features = features.features.size();
  wire.frame_seq = features.frame_seq;
  wire.stamp_us = features.stamp_us;
  wire.published_us = features.published_us;
  wire.decode_ms = features.decode_ms;
  wire.features_ms = features.features_ms;
  CopyFeatures(features.features, &wire.keypoints, &wire.descriptors);
  wire.has_lines = features.lines != nullptr;
  wire.line_set = CopyLineSet(features.lines ? *features.lines : LineSet(), &wire.lines,
                              &wire.vanishing_points);
  wire.num_lines = static_cast<int32_t>(wire.lines.size());
  wire.num_vanishing_points = static_cast<int32_t>(wire.vanishing_points.size());
  return wire;
}

std::optional<FrameFeatures> FromWire(const features_t& wire, std::string* why) {
  FrameFeatures features;
  features.frame_seq = wire.frame_seq;
  features.stamp_us = wire.stamp_us;
  features.published_us = wire.published_us;
  features.decode_ms = wire.decode_ms;
  features.features_ms = wire.features_ms;
  features.features = ReadFeatures(wire.keypoints, wire.descriptors);
  if (wire.has_lines != 0) {
    features.lines = std::make_shared<const LineSet>(
        ReadLineSet(wire.line_set, wire.lines, wire.vanishing_points));
  } else if (wire.num_lines != 0 || wire.num_vanishing_points != 0) {
    *why = "lines where there are to be none";
    return std::nullopt;
  }
  return Checked(std::move(features), why);
}

lines_t ToWire(const LineSet& lines) {
  lines_t wire{};
  wire.set = CopyLineSet(lines, &wire.lines, &wire.vanishing_points);
  wire.num_lines = static_cast<int32_t>(wire.lines.size());
  wire.num_vanishing_points = static_cast<int32_t>(wire.vanishing_points.size());
  return wire;
}

std::optional<LineSet> FromWire(const lines_t& wire, std::string* why) {
  return Checked(ReadLineSet(wire.set, wire.lines, wire.vanishing_points), why);
}

pose_t ToWire(const FramePose& pose) {
  pose_t wire{};
  wire.frame_seq = pose.frame_seq;
  wire.stamp_us = pose.stamp_us;
  wire.image_published_us = pose.image_published_us;
  wire.state = static_cast<int32_t>(pose.state);
  wire.live = pose.live;
  wire.map_id = pose.map.value;
  wire.cam_from_world = ToWirePose(pose.cam_from_world);
  wire.reference = pose.reference.value;
  wire.cam_from_reference = ToWirePose(pose.cam_from_reference);
  for (int i = 0; i < 36; ++i) wire.covariance[i] = pose.covariance(i / 6, i % 6);
  wire.inliers = pose.inliers;
  wire.matches = pose.matches;
  wire.keyframe = pose.keyframe.value;
  wire.times.decode_ms = pose.times.decode_ms;
  wire.times.transport_ms = pose.times.transport_ms;
  wire.times.features_ms = pose.times.features_ms;
  wire.times.lines_ms = pose.times.lines_ms;
  wire.times.vps_ms = pose.times.vps_ms;
  wire.times.wait_for_lines_ms = pose.times.wait_for_lines_ms;
  wire.times.initial_pose_ms = pose.times.initial_pose_ms;
  wire.times.rotation_ms = pose.times.rotation_ms;
  wire.times.translation_ms = pose.times.translation_ms;
  wire.times.local_map_ms = pose.times.local_map_ms;
  wire.times.total_ms = pose.times.total_ms;
  return wire;
}

std::optional<FramePose> FromWire(const pose_t& wire, std::string* why) {
  FramePose pose;
  pose.frame_seq = wire.frame_seq;
  pose.stamp_us = wire.stamp_us;
  pose.image_published_us = wire.image_published_us;
  pose.state = static_cast<TrackingState>(wire.state);
  pose.live = wire.live != 0;
  pose.map = MapId(wire.map_id);
  pose.cam_from_world = FromWirePose(wire.cam_from_world);
  pose.reference = KeyframeId(wire.reference);
  pose.cam_from_reference = FromWirePose(wire.cam_from_reference);
  for (int i = 0; i < 36; ++i) pose.covariance(i / 6, i % 6) = wire.covariance[i];
  pose.inliers = wire.inliers;
  pose.matches = wire.matches;
  pose.keyframe = KeyframeId(wire.keyframe);
  pose.times.decode_ms = wire.times.decode_ms;
  pose.times.transport_ms = wire.times.transport_ms;
  pose.times.features_ms = wire.times.features_ms;
  pose.times.lines_ms = wire.times.lines_ms;
  pose.times.vps_ms = wire.times.vps_ms;
  pose.times.wait_for_lines_ms = wire.times.wait_for_lines_ms;
  pose.times.initial_pose_ms = wire.times.initial_pose_ms;
  pose.times.rotation_ms = wire.times.rotation_ms;
  pose.times.translation_ms = wire.times.translation_ms;
  pose.times.local_map_ms = wire.times.local_map_ms;
  pose.times.total_ms = wire.times.total_ms;
  return Checked(pose, why);
}

truth_t ToWire(const Truth& truth) {
  truth_t wire{};
  wire.frame_seq = truth.frame_seq;
  wire.stamp_us = truth.stamp_us;
  wire.world_from_cam = ToWirePose(truth.world_from_cam);
  return wire;
}

std::optional<Truth> FromWire(const truth_t& wire, std::string* why) {
  Truth truth;
  truth.frame_seq = wire.frame_seq;
  truth.stamp_us = wire.stamp_us;
  truth.world_from_cam = FromWirePose(wire.world_from_cam);
  return Checked(truth, why);
}

preview_t ToWire(const Preview& preview) {
  preview_t wire{};
  wire.num_bytes = static_cast<int32_t>(preview.jpeg.size());
  wire.frame_seq = preview.frame_seq;
  wire.stamp_us = preview.stamp_us;
  wire.jpeg = preview.jpeg;
  return wire;
}

std::optional<Preview> FromWire(const preview_t& wire, std::string* why) {
  Preview preview;
  preview.frame_seq = wire.frame_seq;
  preview.stamp_us = wire.stamp_us;
  preview.jpeg = wire.jpeg;
  return Checked(std::move(preview), why);
}

}  // namespace vpslam
