// The frontend as its process sees it: images, or their features, in; poses and keyframe proposals
// out; map deltas in.
//
// Knows neither LCM nor time: what it does depends on its inputs and their order alone.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "core/features/line_set.h"
#include "core/geometry/camera.h"
#include "core/messages/frame_features.h"
#include "core/messages/frame_pose.h"
#include "core/messages/image_frame.h"
#include "core/messages/keyframe_proposal.h"
#include "core/messages/map_delta.h"
#include "frontend/tracker_options.h"

namespace vpslam {

/// The lines of the image at hand; the first call waits for them, so that a tracker which has other
/// things to do calls late. nullptr where there are none. They last as long as the call to Track.
using GetLines = std::function<const LineSet*()>;

class Tracker {
 public:
  /// What one step brings, to be published in this order.
  struct Output {
    /// Of the image; and of earlier ones that could be placed only now: their `live` is false.
    std::vector<FramePose> poses;
    /// At most two: those that start a map. In lockstep, once both Track and TrackLate are done, no
    /// image goes into the tracker until the map delta that answers the last of them was applied.
    std::vector<KeyframeProposal> keyframes;
  };

  Tracker(const Camera& camera, const TrackerOptions& options, uint64_t seed);
  ~Tracker();

  /// The point features of the next image: as many as the state asks for.
  FrameFeatures Extract(const ImageFrame& image);

  /// `lines`: where the image's lines come from; may be empty. `features.lines` is not looked at.
  Output Track(FrameFeatures features, const GetLines& lines = {});
  Output Track(const ImageFrame& image, const GetLines& lines = {}) {
    return Track(Extract(image), lines);
  }

  /// Places earlier frames that could not be placed when they came; a bounded number of them. Call
  /// it once after each Track, when what that brought is published, since others wait for the pose
  /// of the image; and before further deltas are applied, so that the result depends on the order
  /// of the calls alone.
  Output TrackLate();

  /// Returns false if the delta does not fit the version that the replica has: ask for a snapshot.
  bool Apply(const MapDelta& delta);

  /// To be called when no more images come: poses of earlier frames that are still owed.
  Output Finish();

  int64_t map_version() const;

  /// Where the last frame shows points of the map, in undistorted px; empty if it was not tracked.
  std::vector<Eigen::Vector2f> TrackedPoints() const;

  /// Keyframes that were proposed and are not in the map yet, when the next image is tracked. With
  /// some of them under way, fewer are proposed. 0 in lockstep.
  void SetUnanswered(int keyframes);

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vpslam
