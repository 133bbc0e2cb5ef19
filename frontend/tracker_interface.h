// The frontend's work as its process sees it: images, or their features, in; poses and keyframe
// proposals out; map deltas in. The process knows this interface alone.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "core/messages/frame_features.h"
#include "core/messages/frame_pose.h"
#include "core/messages/image_frame.h"
#include "core/messages/keyframe_proposal.h"
#include "core/messages/map_delta.h"

namespace vpslam {

/// What one step of tracking brings, to be published in this order.
struct TrackerOutput {
  /// Of the image; and of earlier ones that could be placed only now: their `live` is false.
  std::vector<FramePose> poses;
  /// At most two: those that start a map. In lockstep, once both Track and TrackLate are done, no
  /// image goes into the tracker until the map delta that answers the last of them was applied.
  std::vector<KeyframeProposal> keyframes;
};

class TrackerInterface {
 public:
  virtual ~TrackerInterface() = default;

  /// The point features of the next image: as many as the state asks for. Without lines.
  virtual FrameFeatures Extract(const ImageFrame& image) = 0;

  /// Tracks the image by its point features and, where `features.lines` are there, by its lines.
  virtual TrackerOutput Track(FrameFeatures features) = 0;

  /// Places earlier frames that could not be placed when they came; a bounded number of them. Call
  /// it once after each Track, when what that brought is published, since others wait for the pose
  /// of the image; and before further deltas are applied, so that the result depends on the order
  /// of the calls alone.
  virtual TrackerOutput TrackLate() = 0;

  /// Returns false if the delta does not fit the version that the replica has: ask for a snapshot.
  virtual bool Apply(const MapDelta& delta) = 0;

  /// To be called when no more images come: poses of earlier frames that are still owed.
  virtual TrackerOutput Finish() = 0;

  virtual int64_t map_version() const = 0;

  /// Where the last frame shows points of the map, in undistorted px; empty if it was not tracked.
  virtual std::vector<Eigen::Vector2f> TrackedPoints() const = 0;

  /// Keyframes that were proposed and are not in the map yet, when the next image is tracked. With
  /// some of them under way, fewer are proposed. 0 in lockstep.
  virtual void SetUnanswered(int keyframes) = 0;
};

}  // namespace vpslam
