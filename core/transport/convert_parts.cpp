#include "core/transport/convert_parts.h"

#include <algorithm>

namespace vpslam {

void CopyQuaternion(const Eigen::Quaterniond& from, double (&to)[4]) {
  to[0] = from.w();
  to[1] = from.x();
  to[2] = from.y();
  to[3] = from.z();
}

Eigen::Quaterniond ReadQuaternion(const double (&from)[4]) {
  return Eigen::Quaterniond(from[0], from[1], from[2], from[3]);
}

se3_t ToWirePose(const SE3& pose) {
  se3_t wire;
  CopyQuaternion(pose.rotation, wire.rotation);
  for (int i = 0; i < 3; ++i) wire.translation[i] = pose.translation[i];
  return wire;
}

SE3 FromWirePose(const se3_t& wire) {
  SE3 pose;
  pose.rotation = ReadQuaternion(wire.rotation);
  for (int i = 0; i < 3; ++i) pose.translation[i] = wire.translation[i];
  return pose;
}

descriptor_t ToWireDescriptor(const Descriptor& descriptor) {
  descriptor_t wire;
  for (int i = 0; i < 4; ++i) wire.words[i] = std::bit_cast<int64_t>(descriptor[i]);
  return wire;
}

Descriptor FromWireDescriptor(const descriptor_t& wire) {
  Descriptor descriptor;
  for (int i = 0; i < 4; ++i) descriptor[i] = std::bit_cast<uint64_t>(wire.words[i]);
  return descriptor;
}

void CopyFeatures(const Features& from, std::vector<keypoint_t>* keypoints,
                  std::vector<descriptor_t>* descriptors) {
  keypoints->reserve(from.keypoints.size());
  for (const Keypoint& k : from.keypoints) {
    keypoint_t wire;
    wire.x_px = k.x_px;
    wire.y_px = k.y_px;
    wire.angle_rad = k.angle_rad;
    wire.response = k.response;
    wire.octave = k.octave;
    wire.roundness_per_10000 = k.roundness_per_10000;
    wire.edge_mrad = k.edge_mrad;
    keypoints->push_back(wire);
  }
  descriptors->reserve(from.descriptors.size());
  for (const Descriptor& d : from.descriptors) descriptors->push_back(ToWireDescriptor(d));
}

Features ReadFeatures(const std::vector<keypoint_t>& keypoints,
                      const std::vector<descriptor_t>& descriptors) {
  Features features;
  features.keypoints.reserve(keypoints.size());
  for (const keypoint_t& wire : keypoints) {
    Keypoint k;
    k.x_px = wire.x_px;
    k.y_px = wire.y_px;
    k.angle_rad = wire.angle_rad;
    k.response = wire.response;
    k.octave = wire.octave;
    k.roundness_per_10000 = wire.roundness_per_10000;
    k.edge_mrad = wire.edge_mrad;
    features.keypoints.push_back(k);
  }
  features.descriptors.reserve(descriptors.size());
  for (const descriptor_t& wire : descriptors) {
    features.descriptors.push_back(FromWireDescriptor(wire));
  }
  return features;
}

line_set_t CopyLineSet(const LineSet& from, std::vector<line_segment_t>* lines,
                       std::vector<vanishing_point_t>* vanishing_points) {
  line_set_t set;
  set.frame_seq = from.frame_seq;
  set.stamp_us = from.stamp_us;
  set.manhattan = static_cast<int32_t>(from.manhattan);
  CopyQuaternion(from.cam_from_manhattan, set.cam_from_manhattan);
  for (int i = 0; i < 9; ++i) set.covariance_rad2[i] = from.covariance_rad2(i / 3, i % 3);
  set.lines_ms = from.lines_ms;
  set.descriptors_ms = from.descriptors_ms;
  set.vps_ms = from.vps_ms;
  lines->reserve(from.lines.size());
  for (const LineSegment& line : from.lines) {
    line_segment_t wire;
    for (int i = 0; i < 2; ++i) wire.start_px[i] = line.start_px[i];
    for (int i = 0; i < 2; ++i) wire.end_px[i] = line.end_px[i];
    wire.sigma_px = line.sigma_px;
    wire.has_descriptor = line.has_descriptor;
    wire.descriptor = ToWireDescriptor(line.descriptor);
    wire.label = line.label;
    lines->push_back(wire);
  }
  vanishing_points->reserve(from.vanishing_points.size());
  for (const VanishingPoint& vp : from.vanishing_points) {
    vanishing_point_t wire;
    for (int i = 0; i < 3; ++i) wire.direction_in_cam[i] = vp.direction_in_cam[i];
    for (int i = 0; i < 4; ++i) wire.covariance_rad2[i] = vp.covariance_rad2(i / 2, i % 2);
    wire.support = vp.support;
    vanishing_points->push_back(wire);
  }
  return set;
}

LineSet ReadLineSet(const line_set_t& set, const std::vector<line_segment_t>& lines,
                    const std::vector<vanishing_point_t>& vanishing_points) {
  LineSet to;
  to.frame_seq = set.frame_seq;
  to.stamp_us = set.stamp_us;
  to.manhattan = static_cast<ManhattanState>(set.manhattan);
  to.cam_from_manhattan = ReadQuaternion(set.cam_from_manhattan);
  for (int i = 0; i < 9; ++i) to.covariance_rad2(i / 3, i % 3) = set.covariance_rad2[i];
  to.lines_ms = set.lines_ms;
  to.descriptors_ms = set.descriptors_ms;
  to.vps_ms = set.vps_ms;
  to.lines.reserve(lines.size());
  for (const line_segment_t& wire : lines) {
    LineSegment line;
    line.start_px = {wire.start_px[0], wire.start_px[1]};
    line.end_px = {wire.end_px[0], wire.end_px[1]};
    line.sigma_px = wire.sigma_px;
    line.has_descriptor = wire.has_descriptor != 0;
    line.descriptor = FromWireDescriptor(wire.descriptor);
    line.label = wire.label;
    to.lines.push_back(line);
  }
  to.vanishing_points.reserve(vanishing_points.size());
  for (const vanishing_point_t& wire : vanishing_points) {
    VanishingPoint vp;
    for (int i = 0; i < 3; ++i) vp.direction_in_cam[i] = wire.direction_in_cam[i];
    for (int i = 0; i < 4; ++i) vp.covariance_rad2(i / 2, i % 2) = wire.covariance_rad2[i];
    vp.support = wire.support;
    to.vanishing_points.push_back(vp);
  }
  return to;
}

}  // namespace vpslam
