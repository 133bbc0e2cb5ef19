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
#include "frontend/tracker.h"

namespace vpslam {

/// What the loop needs of a tracker; see frontend/tracker.h for what each does. There are no lines
/// without detectors, when they come too late (in realtime), and when the process is about to stop.
struct TrackerCalls {
  std::function<FrameFeatures(const ImageFrame&)> extract;
  std::function<Tracker::Output(const FrameFeatures&, const GetLines&)> track;
  std::function<Tracker::Output()> track_late;
  std::function<bool(const MapDelta&)> apply;
  std::function<Tracker::Output()> finish;
  std::function<int64_t()> map_version;
  /// Called before `track` with the number of keyframes that the backend has not answered; may be
  /// empty.
  std::function<void(int)> set_unanswered = {};
  /// For previews; may be empty.
  std::function<std::vector<Eigen::Vector2f>()> tracked_points = {};
};

/// Called once, when the camera is known.
using MakeTracker = std::function<TrackerCalls(const Camera&)>;

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

  /// Until `frames` has ended: true; false if interrupted.
  template <class T>
  bool WorkOff(StreamReader<T>& frames);
  bool Process(const Images::Item& item);
  bool Process(const ReplayedFeatures::Item& item);
  struct Waits {
    double transport_ms = kNotRun;
    double for_lines_ms = kNotRun;
  };
  Tracker::Output Track(const FrameFeatures& features, const GetLines& lines);
  void OfferPreview(const FrameFeatures& features, const cv::Mat& image);
  /// Publishes what the image brought, then has earlier frames tracked and publishes those.
  bool Publish(Tracker::Output live, const FrameFeatures& features, const Waits& waits,
               const cv::Mat& image);
  bool Send(const Tracker::Output& output);
  bool Finish();
  bool SendPoses(const std::vector<FramePose>& poses);
  /// Takes the map over, if there is one already.
  bool CatchUp();
  bool WaitUntilMapFollows(bool is_start);
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
  const bool always_preview_;
  std::optional<TrackerCalls> tracker_;
  std::unique_ptr<PreviewPublisher> preview_;  ///< when the camera is known

  CameraReceiver camera_;
  std::unique_ptr<Images> images_;  ///< or else
  std::unique_ptr<ReplayedFeatures> replayed_;
  ImageFetcher fetcher_;
  std::unique_ptr<LineSource> lines_;  ///< none without detectors
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
