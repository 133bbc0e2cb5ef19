// The frontend as a process: takes images from the graph, gives them to a tracker, and publishes
// what that says; keeps the tracker's replica of the map up to date. From a log it takes features
// in place of images.
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
#include "core/features/line_set.h"
#include "core/messages/frame_features.h"
#include "core/messages/frame_pose.h"
#include "core/messages/image_frame.h"
#include "core/messages/keyframe_proposal.h"
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
#include "frontend/preview_publisher.h"
#include "frontend/tracker_interface.h"

namespace vpslam {

/// Called once, when the camera is known. The tracker must outlive FrontendProcess::Run.
using MakeTracker = std::function<TrackerInterface&(const Camera&)>;

struct FrontendStreams {
  bool take_features = false;   ///< FEATURES, which somebody replays, instead of IMAGE
  bool recorded = false;        ///< the recorder gets FEATURES and KEYFRAME, nothing left out
  bool always_preview = false;  ///< PREVIEW also while nobody asks for it
};

class FrontendProcess {
 public:
  /// Subscribes. `required` names the processes that acknowledge POSE and KEYFRAME. `lines` says
  /// how images wait for lines; without it no detector is asked.
  FrontendProcess(Bus& bus, Peers& peers, StatusReporter& status,
                  const std::vector<std::string>& required, MakeTracker make_tracker,
                  const std::optional<LineSourceOptions>& lines = std::nullopt,
                  Pace pace = Pace::kLockstep, const FrontendStreams& streams = {});

  /// Until the stream of images has ended and everything is acknowledged, or the bus is
  /// interrupted. Throws PeerGoneError.
  void Run();

 private:
  using Images = StreamReader<ImageMessage>;
  using ReplayedFeatures = StreamReader<FrameFeatures>;

  // What waits throws Interrupted (core/transport/interrupted.h) when the process is to stop.
  /// Until `frames` has ended.
  template <class T>
  void WorkOff(StreamReader<T>& frames);
  void Process(const Images::Item& item);
  void Process(const ReplayedFeatures::Item& item);
  struct Waits {
    double transport_ms = kNotRun;
    double for_lines_ms = kNotRun;
  };
  /// Has the image tracked and publishes what that brings; then the same for earlier frames.
  void Track(const FrameFeatures& features, const Waits& waits, const cv::Mat& image);
  static void SetTimes(const FrameFeatures& features, const Waits& waits, TrackerOutput* output);
  void Send(const TrackerOutput& output);
  void OfferPreview(const FrameFeatures& features, const cv::Mat& image);
  void Finish();
  /// Takes the map over, if there is one already.
  void CatchUp();
  void WaitUntilMapFollows(bool is_start);
  void WaitForAnswers(size_t max_unanswered);
  void TakeWhatCame();
  void AskForSnapshot();
  void TakeDeltasUntil(const std::function<bool()>& enough);
  void CheckBackend();
  void TakeUp(const StreamReader<MapDelta>::Item& item);

  Bus& bus_;
  Peers& peers_;
  StatusReporter& status_;
  const std::vector<std::string> required_;
  const Pace pace_;
  const MakeTracker make_tracker_;
  const bool always_preview_;
  TrackerInterface* tracker_ = nullptr;        ///< when the camera is known
  std::unique_ptr<PreviewPublisher> preview_;  ///< when the camera is known

  CameraReceiver camera_;
  std::unique_ptr<LineSource> lines_;  ///< none without detectors; before images_, which tell it
  std::unique_ptr<Images> images_;     ///< or else
  std::unique_ptr<ReplayedFeatures> replayed_;
  ImageFetcher fetcher_;
  StreamReader<MapDelta> deltas_;
  StreamWriter<FramePose> poses_;
  StreamWriter<KeyframeProposal> keyframes_;
  std::unique_ptr<StreamWriter<FrameFeatures>> features_;  ///< where they are recorded
  Publisher<MapRequest> requests_;

  std::deque<KeyframeId> unanswered_;                ///< proposed, without an answer yet
  std::vector<StreamReader<MapDelta>::Item> parts_;  ///< of an answer that is not complete yet
  bool resyncing_ = false;  ///< the replica missed something and waits for a snapshot
  std::chrono::steady_clock::time_point next_request_;  ///< of that snapshot
  int64_t newest_version_ = 0;                          ///< of the map, as far as deltas told
  std::optional<int64_t> backend_session_;
};

}  // namespace vpslam
