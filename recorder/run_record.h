// All that the recorder has heard of a run: poses, the map, keyframes, processes. Results are made
// from it, at the end or in between.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/ids.h"
#include "core/map/map_replica.h"
#include "core/messages/frame_pose.h"
#include "core/messages/map_delta.h"
#include "core/messages/outcome.h"
#include "core/messages/preview.h"
#include "core/messages/process_status.h"

namespace vpslam {

/// True where the pose is one that was measured in an image.
inline bool IsMeasured(const FramePose& pose) {
  return pose.state == TrackingState::kTracking && pose.inliers > 0;
}

struct FrameRecord {
  FramePose last;                 ///< what holds in the end
  std::optional<FramePose> live;  ///< as it was published when its turn came
};

/// A keyframe that the backend has answered.
struct KeyframeRecord {
  KeyframeId id;
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  MappingTimes times;
};

class RunRecord {
 public:
  void Add(const FramePose& pose);
  void Add(const ProcessStatus& status);
  void Add(const Preview& preview) { preview_ = preview; }
  void Add(const Outcome& outcome) { outcome_ = outcome; }
  /// False if the delta does not fit the version at hand: a snapshot has to be asked for.
  bool Apply(const MapDelta& delta);

  const std::map<int64_t, FrameRecord>& frames() const { return frames_; }  ///< by frame_seq
  const std::map<KeyframeId, KeyframeRecord>& keyframes() const { return keyframes_; }
  const Map& map() const { return map_; }
  /// The newest status of each process, by name and process id: a restarted process is another one.
  const std::map<std::pair<std::string, int32_t>, ProcessStatus>& processes() const {
    return processes_;
  }

  /// The newest; empty where none was asked for.
  const Preview& preview() const { return preview_; }

  /// What the player says of the sequence; an empty object before it has ended.
  const Outcome& outcome() const { return outcome_; }

  /// Images that went out, as far as is known: what the player says, or the frontend's poses show.
  int64_t frames_in() const;
  /// From the first image published to the last pose published.
  double wall_s() const;

 private:
  struct Origin {
    int64_t frame_seq = 0;
    int64_t stamp_us = 0;
  };

  std::map<int64_t, FrameRecord> frames_;
  std::map<KeyframeId, KeyframeRecord> keyframes_;
  std::map<KeyframeId, Origin> origins_;  ///< also of keyframes whose map was erased since
  MapReplica map_;
  Preview preview_;
  Outcome outcome_;
  std::map<std::pair<std::string, int32_t>, ProcessStatus> processes_;
};

}  // namespace vpslam
