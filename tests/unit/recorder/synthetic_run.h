// Messages of a small run, made by hand, for the tests of this folder.
#pragma once

#include <cstdint>

#include "core/messages/frame_pose.h"
#include "core/messages/map_delta.h"
#include "core/messages/process_status.h"

namespace vpslam {

/// No rotation; the camera centre is at (x, y, z), so the translation is (-x, -y, -z).
inline SE3 CamAt(double x, double y = 0, double z = 0) {
  return SE3(Eigen::Quaterniond::Identity(), {-x, -y, -z});
}

/// Camera turned by 90 degrees about its y axis: the world's x axis lies along the camera's -z.
inline SE3 QuarterTurn() {
  return SE3(Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitY())),
             Eigen::Vector3d::Zero());
}

inline KeyframeState MakeKeyframe(int id, int map, int64_t frame_seq, const SE3& cam_from_world) {
  KeyframeState k;
  k.id = KeyframeId(id);
  k.map = MapId(map);
  k.frame_seq = frame_seq;
  k.stamp_us = frame_seq * 100'000;
  k.cam_from_world = cam_from_world;
  return k;
}

inline void AddPoint(int id, int map, const Eigen::Vector3d& position, MapDelta* delta) {
  PointAppearance a;
  a.id = PointId(id);
  a.map = MapId(map);
  delta->appearances.push_back(a);
  PointGeometry g;
  g.id = PointId(id);
  g.position = position;
  delta->geometries.push_back(g);
}

/// A delta that follows `base_version`.
inline MapDelta MakeDelta(int64_t base_version) {
  MapDelta delta;
  delta.base_version = base_version;
  delta.version = base_version + 1;
  return delta;
}

/// Tracked with 50 inliers against keyframe `reference`; published at 1 s + 0.1 s * frame_seq.
inline FramePose MakePose(int64_t frame_seq, int map, int reference, const SE3& cam_from_reference,
                          const SE3& cam_from_world) {
  FramePose p;
  p.frame_seq = frame_seq;
  p.stamp_us = frame_seq * 100'000;
  p.image_published_us = 1'000'000 + frame_seq * 100'000;
  p.state = TrackingState::kTracking;
  p.map = MapId(map);
  p.reference = KeyframeId(reference);
  p.cam_from_reference = cam_from_reference;
  p.cam_from_world = cam_from_world;
  p.inliers = 50;
  p.matches = 60;
  return p;
}

inline ProcessStatus MakeStatus(const char* process, int pid, int64_t processed, double cpu_s,
                                double rss_mb) {
  ProcessStatus s;
  s.process = process;
  s.pid = pid;
  s.state = ProcessState::kRunning;
  s.processed = processed;
  s.cpu_s = cpu_s;
  s.rss_peak_mb = rss_mb;
  return s;
}

}  // namespace vpslam
