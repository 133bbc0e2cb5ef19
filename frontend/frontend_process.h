// The frontend as a process: takes images from the graph, gives them to a tracker, and publishes
// what that says; keeps the tracker's replica of the map up to date.
//
// Lockstep: after a keyframe was proposed, the next image waits until the deltas up to the
// backend's answer were applied. So the tracker sees images and deltas in one order, whatever the
// timing. At the other paces the backend works beside the tracker, and answers are applied as they
// come, each as a whole, between images.
#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "core/base/pace.h"
#include "core/messages/frame_pose.h"
#include "core/messages/image_frame.h"
#include "core/messages/keyframe_proposal.h"
#include "core/messages/line_set.h"
#include "core/messages/map_delta.h"
#include "core/messages/map_request.h"
#include "core/transport/camera_link.h"
#include "core/transport/image_message.h"
#include "core/transport/image_pool.h"
#include "core/transport/peers.h"
#include "core/transport/publisher.h"
#include "core/transport/status_reporter.h"
#include "core/transport/stream_reader.h"
#include "core/transport/stream_writer.h"
#include "frontend/line_source.h"
#include "frontend/tracker.h"

namespace vpslam {

/// What the loop needs of a tracker; see frontend/tracker.h for what each does. There are no lines
/// without detectors, when they come too late (in realtime), and when the process is about to stop.
struct TrackerCalls {
  std::function<Tracker::Output(const ImageFrame&, const GetLines&)> track;
  std::function<bool(const MapDelta&)> apply;
  std::function<Tracker::Output()> finish;
  std::function<int64_t()> map_version;
  /// Called before `track` with the number of keyframes that the backend has not answered; may be
  /// empty.
  std::function<void(int)> set_unanswered = {};
};

/// Called once, when the camera is known.
using MakeTracker = std::function<TrackerCalls(const Camera&)>;

class FrontendProcess {
 public:
  /// Subscribes. `required` names the processes that acknowledge POSE and KEYFRAME. `lines` says
  /// how images wait for lines; without it no detector is asked.
  FrontendProcess(Bus& bus, Peers& peers, StatusReporter& status,
                  const std::vector<std::string>& required, MakeTracker make_tracker,
                  const std::optional<LineSourceOptions>& lines = std::nullopt,
                  Pace pace = Pace::kLockstep);

  /// Until the stream of images has ended and everything is acknowledged, or the bus is
  /// interrupted. Throws PeerGoneError.
  void Run();

 private:
  using Images = StreamReader<ImageMessage>;

  bool Process(const Images::Item& item);
  bool Finish();
  bool SendPoses(const std::vector<FramePose>& poses);
  /// Takes the map over, if there is one already.
  bool CatchUp();
  bool WaitForNews();
  bool WaitUntilMapFollows(const std::vector<KeyframeProposal>& proposed);
  bool WaitForAnswers(size_t max_unanswered);
  void TakeWhatCame();
  void AskForSnapshot();
  bool TakeDeltasUntil(const std::function<bool()>& enough);
  void CheckBackend();
  void TakeUp(const StreamReader<MapDelta>::Item& item);

  Bus& bus_;
  Peers& peers_;
  StatusReporter& status_;
  const std::vector<std::string> required_;
  const Pace pace_;
  const MakeTracker make_tracker_;
  std::optional<TrackerCalls> tracker_;

  CameraReceiver camera_;
  Images images_;
  ImageFetcher fetcher_;
  std::unique_ptr<LineSource> lines_;  ///< none without detectors
  StreamReader<MapDelta> deltas_;
  StreamWriter<FramePose> poses_;
  StreamWriter<KeyframeProposal> keyframes_;
  Publisher<MapRequest> requests_;

  std::deque<KeyframeId> unanswered_;                ///< proposed, without an answer yet
  std::vector<StreamReader<MapDelta>::Item> parts_;  ///< of an answer that is not complete yet
  bool resyncing_ = false;  ///< the replica missed something and waits for a snapshot
  std::chrono::steady_clock::time_point next_request_;  ///< of that snapshot
  int64_t newest_version_ = 0;                          ///< of the map, as far as deltas told
  std::optional<int64_t> backend_session_;
};

}  // namespace vpslam
