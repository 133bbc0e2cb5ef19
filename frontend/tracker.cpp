#include "frontend/tracker.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <random>
#include <utility>

#include "core/base/stopwatch.h"
#include "core/features/octave_check.h"
#include "core/features/orb_extractor.h"
#include "core/map/map_replica.h"
#include "frontend/frame.h"
#include "frontend/frame_tracking.h"
#include "frontend/initializer.h"
#include "frontend/keyframe_policy.h"
#include "frontend/late_tracker.h"
#include "frontend/loss_bridge.h"
#include "frontend/pose_tracker.h"
#include "frontend/relocalizer.h"
#include "frontend/seam_finder.h"

namespace vpslam {
namespace {

OrbOptions WithFeatures(OrbOptions orb, int num_features) {
  orb.num_features = num_features;
  return orb;
}

}  // namespace

class Tracker::Impl {
 public:
  Impl(const Camera& camera, const TrackerOptions& options, uint64_t seed)
      : camera_(camera),
        bounds_(camera.UndistortedBounds()),
        options_(options),
        extractor_(camera, options.orb),
        starting_extractor_(camera, WithFeatures(options.orb, options.num_features_to_start)),
        scales_(extractor_.scales()),
        context_{camera_, bounds_, scales_, map_},
        initializer_(camera_, scales_, options.initializer),
        late_(options),
        poses_(context_, options_),
        relocalizer_(options),
        seams_(options.seams),
        rng_(seed) {}

  FrameFeatures Extract(const ImageFrame& image) {
    Stopwatch stopwatch;
    if (HasToTakeMapOver()) TakeMapOver();
    const bool starting = state_ == TrackingState::kInitialising || WantsNewMap();
    FrameFeatures features;
    features.frame_seq = image.frame_seq;
    features.stamp_us = image.stamp_us;
    features.published_us = image.published_us;
    features.decode_ms = image.decode_ms;
    features.features = (starting ? starting_extractor_ : extractor_).Extract(image.pixels);
    features.features_ms = stopwatch.Lap_ms();
    return features;
  }

  TrackerOutput Track(FrameFeatures features) {
    TrackerOutput output;
    // Features of a log come without a call to Extract.
    if (HasToTakeMapOver()) TakeMapOver();
    Frame frame = MakeFrame(std::move(features));
    if (state_ != TrackingState::kTracking || on_probation_) Remember(frame);
    if (state_ == TrackingState::kInitialising) {
      TryToStart(frame, &output);
    } else {
      TrackInMap(std::move(frame), &output);
    }
    proposed_live_ = output.keyframes.size();
    return SayVersion(std::move(output));
  }

  TrackerOutput TrackLate() {
    TrackerOutput output;
    for (int i = 0; i < options_.late_frames_per_frame; ++i) PlaceLateFrame(&output, true);
    return SayVersion(std::move(output));
  }

  bool Apply(const MapDelta& delta) { return map_.Apply(delta); }

  TrackerOutput Finish() {
    TrackerOutput output;
    if (on_probation_) PassProbation(&output);
    while (late_.Busy()) PlaceLateFrame(&output, false);
    return output;
  }

  int64_t map_version() const { return map_.version(); }
  void SetUnanswered(int keyframes) { unanswered_ = keyframes; }

  std::vector<Eigen::Vector2f> TrackedPoints() const {
    std::vector<Eigen::Vector2f> tracked;
    if (!last_) return tracked;
    for (int i = 0; i < last_->seen->num_features(); ++i) {
      const Keypoint& keypoint = last_->seen->features.keypoints[i];
      if (last_->placement.points()[i].IsValid())
        tracked.emplace_back(keypoint.x_px, keypoint.y_px);
    }
    return tracked;
  }

 private:
  /// The backend forgets what became of old landmarks once all know of it.
  TrackerOutput SayVersion(TrackerOutput output) const {
    for (KeyframeProposal& keyframe : output.keyframes) keyframe.map_version = map_.version();
    return output;
  }
  bool HasToTakeMapOver() const { return next_keyframe_ == 0 && map_.latest_session() >= session_; }

  Frame MakeFrame(FrameFeatures features) {
    Stopwatch stopwatch;
    CheckOctaves(features.features, scales_, "frontend.orb.num_levels");
    Frame frame;
    frame.seen =
        FrameObservation::Make(features.frame_seq, features.stamp_us, std::move(features.features),
                               bounds_, std::move(features.lines));
    frame.published_us = features.published_us;
    frame.times.decode_ms = features.decode_ms;
    frame.times.features_ms = features.features_ms + stopwatch.Lap_ms();
    return frame;
  }

  // ---- Starting a map ----

  void Remember(const Frame& frame) {
    history_.push_back(frame);
    if (static_cast<int>(history_.size()) <= options_.max_buffered_frames) return;
    history_.pop_front();
    bridge_.ForgetNearEnd();
  }

  void TryToStart(Frame& frame, TrackerOutput* output) {
    Stopwatch stopwatch;
    const std::optional<InitialMap> initial = initializer_.Add(frame, rng_);
    frame.times.initial_pose_ms = stopwatch.Lap_ms();
    if (!initial) {
      output->poses.push_back(ToPose(frame, state_));
      return;
    }
    map_id_ = MapId(session_, next_map_++);
    first_ = initial->first;
    first_.PlaceIn(map_id_, SE3());
    frame.PlaceIn(map_id_, initial->second_from_first);
    second_seq_ = frame.seq();
    KeyframeProposal first = MakeProposal(first_, NextKeyframeId());
    first.role = KeyframeRole::kMapFirst;
    first.discarded_map = std::exchange(discarded_map_, MapId());
    KeyframeProposal second = MakeProposal(frame, NextKeyframeId());
    second.role = KeyframeRole::kMapSecond;
    second.initial_points = initial->points;
    first_.placement.BecomeKeyframe(first.id);
    frame.placement.BecomeKeyframe(second.id);
    for (Placement* placement : {&first_.placement, &frame.placement}) {
      placement->inliers = placement->num_matches = static_cast<int>(initial->points.size());
    }
    output->keyframes.push_back(std::move(first));
    output->keyframes.push_back(std::move(second));
    state_ = TrackingState::kTracking;
    on_probation_ = true;
    output->poses.push_back(ToPose(frame, state_));
    output->poses.back().keyframe = frame.placement.reference;
    Accept(std::move(frame));
    velocity_.reset();
    frames_since_keyframe_ = 0;
    poses_.TakeSightings();
    poses_.ForgetDirections();
  }

  /// The map has grown enough to be trusted: earlier frames are placed in it now.
  void PassProbation(TrackerOutput* output) {
    on_probation_ = false;
    std::vector<Frame> frames = bridge_.Cross();
    frames.insert(frames.end(), history_.begin(), history_.end());
    history_.clear();
    FramePose pose = ToPose(first_, TrackingState::kTracking);
    pose.live = false;
    pose.keyframe = first_.placement.reference;
    output->poses.push_back(pose);
    late_.Start(std::move(frames), first_, second_seq_);
  }

  /// The map was started wrongly: try again, with a frame from before as reference.
  void GiveUpMap(const Frame& frame, TrackerOutput* output) {
    discarded_map_ = map_id_;
    on_probation_ = false;
    bridge_.ForgetKept();
    const std::vector<MapId> maps = map_.Maps();
    const auto other =
        std::find_if(maps.rbegin(), maps.rend(), [this](MapId id) { return id != discarded_map_; });
    state_ = other == maps.rend() ? TrackingState::kInitialising : TrackingState::kLost;
    if (other != maps.rend()) map_id_ = *other;
    last_.reset();
    velocity_.reset();
    initializer_.Reset();
    constexpr size_t kFramesBack = 10;
    const size_t n = history_.size();
    if (n > 1) initializer_.Add(history_[n - std::min(n, 1 + kFramesBack)], rng_);
    Frame again = frame;
    again.placement = Placement();
    TryToStart(again, output);
  }

  // ---- Losing the camera, and finding it again ----

  /// Another frontend made the map that is there already: this one was started late, or again.
  void TakeMapOver() {
    session_ = map_.latest_session() + 1;
    map_id_ = map_.Maps().empty() ? MapId() : map_.Maps().back();
    state_ = map_id_.IsValid() ? TrackingState::kLost : TrackingState::kInitialising;
    frames_lost_ = 0;
  }

  bool WantsNewMap() const {
    return state_ == TrackingState::kLost && frames_lost_ >= options_.relocalizer.frames_to_new_map;
  }

  void Lose(Frame& frame, TrackerOutput* output) {
    if (state_ == TrackingState::kTracking) {
      frames_lost_ = 0;
      initializer_.Reset();
      history_.clear();
      if (last_) bridge_.Keep(*last_);
      bridge_.Break();
      Remember(frame);
    }
    state_ = TrackingState::kLost;
    last_.reset();
    velocity_.reset();
    frame.placement = Placement();
    if (WantsNewMap()) return TryToStart(frame, output);
    ++frames_lost_;
    output->poses.push_back(ToPose(frame, state_));
  }

  void Return(const Frame& frame) {
    map_id_ = frame.placement.map();
    late_.Return({history_.begin(), history_.end()}, frame);
    history_.clear();
    bridge_.ForgetNearEnd();
    whereabouts_.Forget();
    initializer_.Reset();
  }

  // ---- Tracking ----

  void TrackInMap(Frame frame, TrackerOutput* output) {
    Stopwatch stopwatch;
    if (const MapId present = map_.Resolve(map_id_); present != map_id_) {
      map_id_ = present;
      poses_.ForgetDirections();  // they are of a world that is no more
    }
    if (last_) last_->placement.Follow(map_, *last_->seen, velocity_ ? &*velocity_ : nullptr);
    bool placed =
        state_ == TrackingState::kTracking && last_ && poses_.TrackFrom(*last_, velocity_, &frame);
    bool relocalized = false;
    if (!placed && !on_probation_) {
      relocalized = placed =
          relocalizer_.Find(context_, {discarded_map_}, whereabouts_, rng_, &frame);
      if (relocalized) poses_.ForgetDirections();  // they are of another world, or of elsewhere
    }
    frame.times.initial_pose_ms = stopwatch.Lap_ms();
    LocalMap local;
    if (placed) placed = poses_.TrackLocalMap(rng_, &frame, &local);
    frame.times.local_map_ms = stopwatch.Lap_ms();
    ++frames_since_keyframe_;
    if (!placed) {
      if (on_probation_) return GiveUpMap(frame, output);
      return Lose(frame, output);
    }
    if (relocalized) Return(frame);
    state_ = TrackingState::kTracking;
    const auto seam =
        on_probation_ || relocalized || unanswered_ >= options_.keyframes.max_unanswered_when_weak
            ? std::nullopt
            : seams_.Look(context_, frame, discarded_map_, rng_, &relocalizer_);
    if (seam || IsKeyframe(frame, local.reference, {frames_since_keyframe_, unanswered_}, map_,
                           options_.keyframes)) {
      Propose(&frame, output);
      if (seam) output->keyframes.back().seam = *seam;
    }
    output->poses.push_back(ToPose(frame, state_));
    if (!output->keyframes.empty()) output->poses.back().keyframe = frame.placement.reference;
    if (last_ && !relocalized) {
      velocity_ = frame.placement.cam_from_world * last_->placement.cam_from_world.Inverse();
    } else {
      velocity_.reset();
    }
    Accept(std::move(frame));
    if (on_probation_ && map_.NumKeyframes(map_id_) >= options_.probation_keyframes) {
      PassProbation(output);
    }
  }

  void Propose(Frame* frame, TrackerOutput* output) {
    KeyframeProposal proposal = MakeProposal(*frame, NextKeyframeId());
    proposal.discarded_map = std::exchange(discarded_map_, MapId());
    proposal.sightings = poses_.TakeSightings();
    frames_since_keyframe_ = 0;
    frame->placement.BecomeKeyframe(proposal.id);
    output->keyframes.push_back(std::move(proposal));
  }

  void Accept(Frame frame) {
    if (!on_probation_) whereabouts_.See(frame);
    if (last_) bridge_.Keep(std::move(*last_));
    last_ = std::move(frame);
  }

  // ---- Frames from before the map ----

  /// Where little of the map is left to be seen, what was seen then is worked into it.
  void PlaceLateFrame(TrackerOutput* output, bool may_propose) {
    if (!late_.Busy()) return bridge_.EndCrossing();
    if (may_propose && late_.Waits(map_)) return;
    std::optional<Frame> frame = late_.Step(context_);
    if (!frame) return;
    const bool has_pose = bridge_.Has(*frame);
    const auto seam = bridge_.SeamAt(map_, *frame);
    if (has_pose && !(seam && may_propose)) return late_.EndWalk();
    const bool is_keyframe =
        may_propose && unanswered_ == 0 && proposed_live_ + output->keyframes.size() < 2 &&
        late_.frames_since_keyframe() >= options_.late_frames_per_keyframe &&
        (seam || IsWeaklyTracked(*frame, frame->placement.reference, map_, options_.keyframes));
    if (is_keyframe) {
      output->keyframes.push_back(MakeProposal(*frame, NextKeyframeId()));
      if (seam) output->keyframes.back().seam = *seam;
      frame->placement.BecomeKeyframe(output->keyframes.back().id);
      late_.GoOnFrom(*frame);
    }
    if (has_pose) return;
    output->poses.push_back(ToPose(*frame, TrackingState::kTracking));
    output->poses.back().live = false;
    output->poses.back().map = frame->placement.map();
    if (is_keyframe) output->poses.back().keyframe = frame->placement.reference;
  }

  KeyframeId NextKeyframeId() { return KeyframeId(session_, next_keyframe_++); }

  FramePose ToPose(const Frame& frame, TrackingState state) const {
    FramePose pose;
    pose.frame_seq = frame.seen->frame_seq;
    pose.stamp_us = frame.seen->stamp_us;
    pose.image_published_us = frame.published_us;
    pose.state = state;
    pose.map = map_id_;
    pose.times = frame.times;
    if (state != TrackingState::kTracking) return pose;
    pose.cam_from_world = frame.placement.cam_from_world;
    pose.reference = frame.placement.reference;
    pose.cam_from_reference = frame.placement.cam_from_reference;
    pose.covariance = frame.placement.covariance;
    pose.inliers = frame.placement.inliers;
    pose.matches = frame.placement.num_matches;
    return pose;
  }

  Camera camera_;
  Camera::Bounds bounds_;
  TrackerOptions options_;
  OrbExtractor extractor_, starting_extractor_;
  ScalePyramid scales_;
  MapReplica map_;  ///< the replica
  TrackingContext context_;
  Initializer initializer_;
  LateTracker late_;
  PoseTracker poses_;
  Relocalizer relocalizer_;
  Whereabouts whereabouts_;
  SeamFinder seams_;
  LossBridge bridge_;
  std::mt19937_64 rng_;

  TrackingState state_ = TrackingState::kInitialising;
  MapId map_id_;
  MapId discarded_map_;        ///< to be told to the backend with the next keyframe
  bool on_probation_ = false;  ///< the map is young: it may have been started wrongly
  int frames_lost_ = 0;
  int32_t session_ = 0;  ///< of the ids that are given here
  int64_t next_map_ = 0, next_keyframe_ = 0;
  int frames_since_keyframe_ = 0;
  int unanswered_ = 0;
  size_t proposed_live_ = 0;     ///< keyframes, by the last call to Track
  std::optional<Frame> last_;    ///< the last frame, while tracking
  std::optional<SE3> velocity_;  ///< this frame's camera from the last one's
  /// Frames that may be placed later: since before the map, until it has passed its probation;
  /// since the camera was lost.
  std::deque<Frame> history_;
  Frame first_;  ///< that became the map's first keyframe
  int64_t second_seq_ = 0;
};

std::optional<std::string> TrackerOptions::Validate() const {
  if (const auto why = orb.Validate()) return why;
  if (const auto why = initializer.two_view.Validate()) return why;
  if (const auto why = initializer.resting.Validate()) return why;
  if (num_features_to_start < orb.num_features) {
    return "num_features_to_start must not be less than orb.num_features";
  }
  if (probation_keyframes < 2) return "probation_keyframes must be at least 2";
  return std::nullopt;
}

Tracker::Tracker(const Camera& camera, const TrackerOptions& options, uint64_t seed)
    : impl_(std::make_unique<Impl>(camera, options, seed)) {}
Tracker::~Tracker() = default;
FrameFeatures Tracker::Extract(const ImageFrame& image) { return impl_->Extract(image); }
TrackerOutput Tracker::Track(FrameFeatures features) { return impl_->Track(std::move(features)); }
TrackerOutput Tracker::TrackLate() { return impl_->TrackLate(); }
bool Tracker::Apply(const MapDelta& delta) { return impl_->Apply(delta); }
TrackerOutput Tracker::Finish() { return impl_->Finish(); }
void Tracker::SetUnanswered(int keyframes) { impl_->SetUnanswered(keyframes); }
int64_t Tracker::map_version() const { return impl_->map_version(); }
std::vector<Eigen::Vector2f> Tracker::TrackedPoints() const { return impl_->TrackedPoints(); }

}  // namespace vpslam
