#include "frontend/frontend_process.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <spdlog/spdlog.h>

#include "core/base/stopwatch.h"
#include "core/transport/channels.h"
#include "core/transport/clock.h"
#include "core/transport/interrupted.h"

namespace vpslam {
namespace {

constexpr const char* kName = "frontend";
constexpr const char* kBackend = "backend";
constexpr const char* kPlayer = "player";
constexpr std::chrono::milliseconds kRequestPeriod{500};
constexpr std::chrono::hours kForever{24 * 365};
constexpr int kFeaturesWindow = 4;  // of some 60 kB

/// Images that wait in realtime; beyond that the oldest is dropped. A hitch of 0.1 s costs none.
constexpr std::size_t kRealtimeQueue = 3;
/// Keyframes under work in lossless, before the next image waits.
constexpr std::size_t kLosslessUnanswered = 2;

StreamWriterOptions Window(int window, bool drop_oldest = false) {
  StreamWriterOptions options;
  options.window = window;
  options.drop_oldest = drop_oldest;
  return options;
}

/// An answer, or a snapshot, is taken up as a whole: the map makes no sense in between.
bool IsComplete(const MapDelta& part) {
  return part.answers.IsValid() || (part.version >= 0 && (part.snapshot || part.base_version < 0));
}

double ElapsedMs(int64_t since_us) {
  return static_cast<double>(MonotonicMicroseconds() - since_us) * 1e-3;
}

}  // namespace

FrontendProcess::FrontendProcess(Bus& bus, Peers& peers, StatusReporter& status,
                                 const std::vector<std::string>& required, MakeTracker make_tracker,
                                 const std::optional<LineSourceOptions>& lines, Pace pace,
                                 const FrontendStreams& streams)
    : bus_(bus),
      peers_(peers),
      status_(status),
      required_(required),
      pace_(pace),
      make_tracker_(std::move(make_tracker)),
      always_preview_(streams.always_preview),
      camera_(bus),
      lines_(lines ? std::make_unique<LineSource>(bus, peers, *lines) : nullptr),
      deltas_(bus, kMapChannel, kName, AckPolicy::kOnReceipt),
      poses_(bus, kPoseChannel, RequiredConsumers(kPoseConsumers, required),
             Window(64, pace == Pace::kRealtime)),
      keyframes_(bus, kKeyframeChannel,
                 AndRecorderIf(streams.recorded, RequiredConsumers(kKeyframeConsumers, required)),
                 Window(2)),
      requests_(bus, kMapRequestChannel) {
  const std::size_t capacity = pace == Pace::kRealtime ? kRealtimeQueue : Images::kUnbounded;
  if (streams.take_features) {
    replayed_ = std::make_unique<ReplayedFeatures>(bus, kFeaturesChannel, kName,
                                                   AckPolicy::kWhenDone, capacity);
    return;
  }
  // Detectors begin while the image waits for its turn.
  const auto ask_for_lines = [lines = lines_.get()](const Decoded<ImageMessage>& image, auto&&) {
    const bool has_image = !image.header.last;
    if (lines && has_image) lines->AddImage(image.header.session, image.value.frame_seq);
    return true;
  };
  images_ = std::make_unique<Images>(bus, kImageChannel, kName, AckPolicy::kWhenDone, capacity,
                                     ask_for_lines);
  if (streams.recorded) {
    features_ = std::make_unique<StreamWriter<FrameFeatures>>(
        bus, kFeaturesChannel, AndRecorderIf(true, {}),
        Window(kFeaturesWindow, pace == Pace::kRealtime));
  }
}

void FrontendProcess::Run() {
  try {
    status_.SetState(ProcessState::kReady);
    const std::optional<Camera> camera = camera_.Wait(peers_);
    UnlessInterrupted(camera.has_value());
    tracker_ = &make_tracker_(*camera);
    preview_ = std::make_unique<PreviewPublisher>(bus_, *camera, always_preview_);
    CatchUp();
    CheckBackend();
    status_.SetState(ProcessState::kRunning);
    if (replayed_) {
      WorkOff(*replayed_);
    } else {
      WorkOff(*images_);
    }
    Finish();
    spdlog::info("end of the sequence");
  } catch (const Interrupted&) {
    // Whoever told the process to stop waits for nothing more.
  }
}

template <class T>
void FrontendProcess::WorkOff(StreamReader<T>& frames) {
  const auto news = [&] {
    return frames.HasNews() || (pace_ != Pace::kLockstep && deltas_.HasMessage());
  };
  const auto queue = status_.WatchQueue([&frames] { return static_cast<int64_t>(frames.size()); });
  while (true) {
    UnlessInterrupted(peers_.WaitFor(news, {kPlayer}));
    if (frames.Ended()) return;
    if (const auto item = frames.TryTake()) {
      Process(*item);
      frames.Done(item->header);
      status_.AddProcessed();
    }
    if (pace_ != Pace::kLockstep) TakeWhatCame();
  }
}

void FrontendProcess::Process(const Images::Item& item) {
  std::string why;
  const std::optional<ImageFrame> image = fetcher_.Fetch(item.value, &why);
  if (!image) return CountRejected(bus_, kImageChannel, why);
  Waits waits;
  waits.transport_ms = ElapsedMs(image->published_us);
  if (item.restarted && lines_) lines_->Restart();
  FrameFeatures features = tracker_->Extract(*image);
  if (lines_) {
    Stopwatch watch;
    // A detector is not done with the image's slot before its lines are there.
    if (auto lines = lines_->WaitFor(*image)) {
      features.lines = std::make_shared<const LineSet>(*std::move(lines));
    }
    waits.for_lines_ms = watch.Lap_ms();
    UnlessInterrupted(!bus_.interrupted());
  }
  Track(features, waits, image->pixels);
}

void FrontendProcess::Process(const ReplayedFeatures::Item& item) {
  Waits waits;
  waits.transport_ms = ElapsedMs(item.value.published_us);
  Track(item.value, waits, cv::Mat());
}

void FrontendProcess::Track(const FrameFeatures& features, const Waits& waits,
                            const cv::Mat& image) {
  tracker_->SetUnanswered(static_cast<int>(unanswered_.size()));
  TrackerOutput live = tracker_->Track(features);
  SetTimes(features, waits, &live);
  Send(live);
  // Behind what others wait for, and while the backend works.
  if (features_) UnlessInterrupted(features_->Send(features));
  OfferPreview(features, image);
  const TrackerOutput late = tracker_->TrackLate();
  Send(late);
  if (live.keyframes.empty() && late.keyframes.empty()) return;
  const bool is_start = std::any_of(live.keyframes.begin(), live.keyframes.end(),
                                    [](const auto& k) { return k.role != KeyframeRole::kRegular; });
  WaitUntilMapFollows(is_start);
}

void FrontendProcess::SetTimes(const FrameFeatures& features, const Waits& waits,
                               TrackerOutput* output) {
  for (FramePose& pose : output->poses) {
    if (!pose.live || pose.frame_seq != features.frame_seq) continue;
    pose.image_published_us = features.published_us;
    pose.times.decode_ms = features.decode_ms;
    pose.times.transport_ms = waits.transport_ms;
    pose.times.wait_for_lines_ms = waits.for_lines_ms;
    if (features.lines) {
      pose.times.lines_ms = features.lines->lines_ms + features.lines->descriptors_ms;
      pose.times.vps_ms = features.lines->vps_ms;
    }
    pose.times.total_ms = ElapsedMs(features.published_us);
  }
}

void FrontendProcess::Send(const TrackerOutput& output) {
  for (const FramePose& pose : output.poses) UnlessInterrupted(poses_.Send(pose));
  for (const KeyframeProposal& keyframe : output.keyframes) {
    UnlessInterrupted(keyframes_.Send(keyframe));
    unanswered_.push_back(keyframe.id);
  }
}

void FrontendProcess::OfferPreview(const FrameFeatures& features, const cv::Mat& image) {
  preview_->Offer([&] {
    return PreviewScene{features.frame_seq, features.stamp_us, image, tracker_->TrackedPoints(),
                        features.lines};
  });
}

void FrontendProcess::WaitUntilMapFollows(bool is_start) {
  // Without the first views of a map there is nothing to track in.
  if (pace_ == Pace::kLockstep || is_start) {
    WaitForAnswers(0);
  } else if (pace_ == Pace::kLossless) {
    WaitForAnswers(kLosslessUnanswered - 1);
  }
}

void FrontendProcess::CatchUp() {
  // A backend that is needed is waited for, since only it can tell whether there is a map already.
  const std::vector<std::string> missing = RequiredConsumers(kKeyframeConsumers, required_);
  UnlessInterrupted(peers_.WaitFor([&] { return peers_.NotReady(missing).empty(); }, missing));
  const auto backend = peers_.Get(kBackend);
  if (!backend || backend->processed == 0) return;
  spdlog::info("there is a map already; asking for it");
  resyncing_ = true;
  TakeDeltasUntil([this] { return !resyncing_; });
}

void FrontendProcess::WaitForAnswers(size_t max_unanswered) {
  TakeDeltasUntil([&] { return unanswered_.size() <= max_unanswered && !resyncing_; });
}

void FrontendProcess::AskForSnapshot() {
  const auto now = std::chrono::steady_clock::now();
  if (!resyncing_ || now < next_request_) return;
  requests_.Publish({kName, std::max<int64_t>(tracker_->map_version(), 0)});
  next_request_ = now + kRequestPeriod;
}

void FrontendProcess::TakeWhatCame() {
  while (auto item = deltas_.TryTake()) {
    parts_.push_back(std::move(*item));
    if (!IsComplete(parts_.back().value)) continue;
    for (const auto& part : parts_) TakeUp(part);
    parts_.clear();
  }
  AskForSnapshot();
  if (!unanswered_.empty()) CheckBackend();
}

void FrontendProcess::TakeDeltasUntil(const std::function<bool()>& enough) {
  for (const auto& part : std::exchange(parts_, {})) TakeUp(part);
  UnheardNotice notice;
  while (!enough()) {
    AskForSnapshot();
    notice.Look(bus_, peers_, {kBackend});
    if (!bus_.WaitFor([this] { return deltas_.HasMessage(); }, kRequestPeriod)) {
      UnlessInterrupted(!bus_.interrupted());
      CheckBackend();
      continue;
    }
    if (const auto item = deltas_.TryTake()) TakeUp(*item);
  }
}

void FrontendProcess::CheckBackend() {
  if (const auto why = peers_.WhyGone(kBackend); why && !deltas_.HasMessage()) {
    throw PeerGoneError(*why);
  }
  const auto session = peers_.Session(kBackend);
  if (backend_session_ && session != backend_session_) {
    throw PeerGoneError("the backend was restarted and its map is lost; start the run again");
  }
  backend_session_ = session;
}

void FrontendProcess::TakeUp(const StreamReader<MapDelta>::Item& item) {
  const MapDelta& delta = item.value;
  while (!unanswered_.empty() && unanswered_.front() <= delta.answers) unanswered_.pop_front();
  newest_version_ = std::max(newest_version_, delta.version);
  if (resyncing_) {
    // Deltas are refused until the snapshot begins, and fit one another from there on. The replica
    // has a version below 0 until the snapshot is complete.
    if (tracker_->Apply(delta) && tracker_->map_version() >= newest_version_) resyncing_ = false;
    return;
  }
  // A snapshot that another replica asked for says nothing new.
  if (delta.version <= tracker_->map_version()) return;
  if (tracker_->Apply(delta)) return;
  spdlog::warn(
      "the replica has version {} of the map, but a change starts at {}; asking for a "
      "snapshot",
      tracker_->map_version(), delta.base_version);
  resyncing_ = true;
}

void FrontendProcess::Finish() {
  WaitForAnswers(0);
  Send(tracker_->Finish());
  UnlessInterrupted(poses_.SendEnd() && keyframes_.SendEnd());
  if (features_) UnlessInterrupted(features_->SendEnd() && features_->WaitAllAcked(kForever));
  UnlessInterrupted(poses_.WaitAllAcked(kForever) && keyframes_.WaitAllAcked(kForever));
  // The backend ends MAP next, and waits until this process has received that.
  if (!peers_.Get(kBackend)) return;
  while (!deltas_.Ended()) {
    UnlessInterrupted(peers_.WaitFor([this] { return deltas_.HasNews(); }, {kBackend}));
    deltas_.TryTake();
  }
}

}  // namespace vpslam
