// Frontend and backend in lockstep on a walk through a made-up place.
#pragma once

#include <map>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "backend/mapper.h"
#include "core/map/map.h"
#include "core/map/map_replica.h"
#include "core/transport/codec.h"
#include "frontend/tracker.h"
#include "tests/unit/frontend/rendered_room.h"
#include "tests/unit/synthetic_scene.h"

namespace vpslam {

inline const RenderedRoom& Room() {
  static const RenderedRoom room(1);
  return room;
}

/// A walk along the wall.
inline SE3 OnTheWay(int i) {
  return PoseAt({0.06 * i, 0.08 * std::sin(0.2 * i), 0.1 * std::sin(0.1 * i)},
                {0.01 * std::sin(0.3 * i), 0.05 * std::sin(0.1 * i), 0.01 * std::cos(0.3 * i)});
}
inline cv::Mat ImageOf(int i) {
  static std::map<int, cv::Mat> images;
  cv::Mat& image = images[i];
  if (image.empty()) image = Room().Render(OnTheWay(i));
  return image;
}

/// Frontend and backend in lockstep.
class Lockstep {
 public:
  explicit Lockstep(const TrackerOptions& options = {})
      : tracker(Room().camera, options, 1), mapper(Room().camera, MapperOptions()) {}

  Tracker tracker;
  Mapper mapper;
  MapReplica replica;
  std::map<int64_t, FramePose> poses;        ///< the last of each frame
  std::map<int64_t, FramePose> first_poses;  ///< as they were when the frame was new
  std::vector<KeyframeProposal> keyframes;
  std::string bytes;  ///< of all that was published

  /// What the frame's pose was when it was new.
  FramePose Track(const cv::Mat& image) {
    ImageFrame frame;
    frame.frame_seq = next_seq_++;
    frame.stamp_us = 1000 * frame.frame_seq;
    frame.pixels = image;
    const TrackerOutput live = tracker.Track(tracker.Extract(frame)), late = tracker.TrackLate();
    for (const auto* output : {&live, &late}) TakePoses(*output);
    for (const auto* output : {&live, &late}) TakeKeyframes(*output);
    for (const FramePose& pose : live.poses) {
      if (pose.frame_seq == frame.frame_seq) return pose;
    }
    ADD_FAILURE() << "no pose for frame " << frame.frame_seq;
    return {};
  }
  void Finish() { TakePoses(tracker.Finish()); }
  void Walk(int begin, int end) {
    for (int i = begin; i < end; ++i) Track(ImageOf(i));
  }
  void Apply(const std::vector<MapDelta>& deltas) {
    for (const MapDelta& delta : deltas) {
      EXPECT_TRUE(tracker.Apply(delta));
      EXPECT_TRUE(replica.Apply(delta));
    }
  }
  /// As the map has it now.
  bool PoseOf(int64_t seq, SE3* cam_from_world) const {
    const auto at = poses.find(seq);
    if (at == poses.end() || at->second.state != TrackingState::kTracking) return false;
    return replica.Place(at->second.reference, at->second.cam_from_reference, cam_from_world);
  }

 private:
  void TakePoses(const TrackerOutput& output) {
    for (FramePose pose : output.poses) {
      poses[pose.frame_seq] = pose;
      first_poses.try_emplace(pose.frame_seq, pose);
      ExpectConsistent(pose);
      pose.times = TrackingTimes();
      Append(Encode(Header(), pose));
    }
  }
  void TakeKeyframes(const TrackerOutput& output) {
    for (const KeyframeProposal& proposal : output.keyframes) {
      keyframes.push_back(proposal);
      Append(Encode(Header(), proposal));
      Apply(mapper.Process(proposal));
    }
  }
  /// Both ways to say where the frame stands agree, in the map as it is when they are said.
  void ExpectConsistent(const FramePose& pose) const {
    SE3 placed;
    if (pose.state != TrackingState::kTracking) return;
    if (!replica.Place(pose.reference, pose.cam_from_reference, &placed)) {
      EXPECT_EQ(pose.keyframe, pose.reference) << "what is not in the map is on its way there";
      return;
    }
    EXPECT_LT(LocalCoordinates(placed, pose.cam_from_world).norm(), 1e-9)
        << "frame " << pose.frame_seq;
  }
  void Append(const std::vector<uint8_t>& encoded) { bytes.append(encoded.begin(), encoded.end()); }

  int64_t next_seq_ = 0;
};

}  // namespace vpslam
