// Tracks images as they come: starts maps, follows the camera in them, and finds it again.
#pragma once

#include <random>
#include <vector>

#include <Eigen/Core>

#include "frontend/frame_tracking.h"
#include "frontend/keyframe_proposer.h"
#include "frontend/late_work.h"
#include "frontend/live_states.h"
#include "frontend/pose_tracker.h"
#include "frontend/relocalization_gate.h"
#include "frontend/relocalizer.h"
#include "frontend/seam_finder.h"
#include "frontend/tracker_interface.h"
#include "frontend/tracker_options.h"

namespace vpslam {

class LiveTracker {
 public:
  /// All must outlive it.
  LiveTracker(const TrackingContext& context, const TrackerOptions& options, uint64_t seed,
              KeyframeProposer* proposer, LateWork* late);

  void Track(Frame frame, TrackerOutput* output);
  /// No image comes any more: a map that is still on probation is taken as it is.
  void Finish(TrackerOutput* output);
  /// Another frontend made the map that is there already: this one was started late, or again.
  void TakeMapOver();

  /// Whether the next image may be a view that starts a map.
  bool LooksForStart() const;
  /// Where the last image shows points of the map, in undistorted px; empty if it has no place.
  std::vector<Eigen::Vector2f> TrackedPoints() const;

 private:
  // One image in each state. Each returns the next state.
  LiveState Step(Starting now, Frame frame, TrackerOutput* output);
  LiveState Step(OnProbation now, Frame frame, TrackerOutput* output);
  LiveState Step(Tracking now, Frame frame, TrackerOutput* output);
  LiveState Step(Lost now, Frame frame, TrackerOutput* output);

  // ---- Starting a map (live_tracker_start.cpp) ----

  Initializer NewInitializer() const;
  /// Tries the frame as the second view of a map. If none can be started, the state stays.
  template <class State>
  LiveState TryToStart(State now, Frame frame, TrackerOutput* output);
  OnProbation StartMap(const InitialMap& initial, Frame frame, TrackerOutput* output);
  Tracking PassProbation(OnProbation now, TrackerOutput* output);
  /// The map was started wrongly. Tries to start another one, with a frame from before as the first
  /// view.
  LiveState GiveMapUp(OnProbation now, Frame frame, TrackerOutput* output);

  // ---- Following the camera (live_tracker.cpp) ----

  struct Attempt {
    bool succeeded = false;
    bool relocalized = false;
    KeyframeId reference;  ///< shares most with the frame
  };
  /// Places the frame in the map from the motion before it (if there is one) or else, if
  /// `anywhere`, by finding it in any map. A frame that could not be placed is in no map.
  Attempt Place(const Motion* motion, bool anywhere, Frame* frame);
  /// To be called when the map may have changed: brings the motion up to date.
  void FollowMap(Motion* motion);
  /// Reports a frame that was placed, as a keyframe where it should be one. `seek_others`: look for
  /// other maps that show the same place.
  void Report(Frame* frame, KeyframeId reference, bool seek_others, TrackerOutput* output);
  LiveState Lose(Tracking now, Frame frame, TrackerOutput* output);
  LiveState StayLost(Lost now, Frame frame, TrackerOutput* output);
  bool WantsNewMap(const Lost& now) const;

  const TrackingContext& context_;
  const TrackerOptions& options_;
  KeyframeProposer& proposer_;
  LateWork& late_;
  PoseTracker poses_;
  Relocalizer relocalizer_;
  RelocalizationGate gate_;
  SeamFinder seams_;
  std::mt19937_64 rng_;
  LiveState state_;
};

}  // namespace vpslam
