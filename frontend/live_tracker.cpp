#include "frontend/live_tracker.h"

#include <utility>
#include <variant>

#include "core/base/stopwatch.h"
#include "frontend/keyframe_policy.h"
#include "frontend/local_map.h"
#include "frontend/pose_report.h"

namespace vpslam {

LiveTracker::LiveTracker(const TrackingContext& context, const TrackerOptions& options,
                         uint64_t seed, KeyframeProposer* proposer, LateWork* late)
    : context_(context),
      options_(options),
      proposer_(*proposer),
      late_(*late),
      poses_(context, options),
      relocalizer_(options),
      seams_(options.seams),
      rng_(seed),
      state_(Starting{NewInitializer(), {}}) {}

void LiveTracker::Track(Frame frame, TrackerOutput* output) {
  state_ =
      std::visit([&](auto& now) { return Step(std::move(now), std::move(frame), output); }, state_);
}

bool LiveTracker::LooksForStart() const {
  const Lost* lost = std::get_if<Lost>(&state_);
  return std::holds_alternative<Starting>(state_) || (lost && WantsNewMap(*lost));
}

std::vector<Eigen::Vector2f> LiveTracker::TrackedPoints() const {
  const Frame* last = nullptr;
  if (const auto* state = std::get_if<OnProbation>(&state_)) last = &state->motion.last;
  if (const auto* state = std::get_if<Tracking>(&state_)) last = &state->motion.last;
  if (!last) return {};
  std::vector<Eigen::Vector2f> tracked;
  for (int i = 0; i < last->seen->num_features(); ++i) {
    const Keypoint& keypoint = last->seen->features.keypoints[i];
    if (last->placement.points()[i].IsValid()) tracked.emplace_back(keypoint.x_px, keypoint.y_px);
  }
  return tracked;
}

// ---- The states ----

LiveState LiveTracker::Step(Starting now, Frame frame, TrackerOutput* output) {
  now.pending.Add(frame, options_.max_buffered_frames);
  return TryToStart(std::move(now), std::move(frame), output);
}

LiveState LiveTracker::Step(OnProbation now, Frame frame, TrackerOutput* output) {
  now.pending.Add(frame, options_.max_buffered_frames);
  FollowMap(&now.motion);
  const Attempt attempt = Place(&now.motion, false, &frame);
  if (!attempt.succeeded) return GiveMapUp(std::move(now), std::move(frame), output);
  Report(&frame, attempt.reference, false, output);
  now.recent.Add(now.motion.last);
  now.motion.Advance(std::move(frame));
  const MapId map = now.motion.last.placement.map();
  if (context_.map.NumKeyframes(map) < options_.probation_keyframes) return now;
  return PassProbation(std::move(now), output);
}

LiveState LiveTracker::Step(Tracking now, Frame frame, TrackerOutput* output) {
  FollowMap(&now.motion);
  const Attempt attempt = Place(&now.motion, true, &frame);
  if (!attempt.succeeded) return Lose(std::move(now), std::move(frame), output);
  if (attempt.relocalized) gate_.Forget();
  Report(&frame, attempt.reference, !attempt.relocalized, output);
  gate_.See(frame);
  now.recent.Add(now.motion.last);
  if (attempt.relocalized) {
    now.motion = {std::move(frame), std::nullopt};
  } else {
    now.motion.Advance(std::move(frame));
  }
  return now;
}

LiveState LiveTracker::Step(Lost now, Frame frame, TrackerOutput* output) {
  now.pending.Add(frame, options_.max_buffered_frames);
  now.map = context_.map.Resolve(now.map);
  const Attempt attempt = Place(nullptr, true, &frame);
  if (!attempt.succeeded) return StayLost(std::move(now), std::move(frame), output);
  late_.PlaceBackFrom(frame, now.pending);
  gate_.Forget();
  Report(&frame, attempt.reference, false, output);
  gate_.See(frame);
  return Tracking{{std::move(frame), std::nullopt}, {}};
}

// ---- Following the camera ----

LiveTracker::Attempt LiveTracker::Place(const Motion* motion, bool anywhere, Frame* frame) {
  Stopwatch stopwatch;
  Attempt attempt;
  bool has_pose = motion && poses_.TrackFrom(motion->last, motion->velocity, frame);
  if (!has_pose && anywhere) {
    has_pose = attempt.relocalized =
        relocalizer_.Find(context_, {proposer_.discarded_map()}, gate_, rng_, frame);
    // The directions are those of another place, or of another world.
    if (has_pose) poses_.ForgetDirections();
  }
  frame->times.initial_pose_ms = stopwatch.Lap_ms();
  LocalMap local;
  attempt.succeeded = has_pose && poses_.TrackLocalMap(rng_, frame, &local);
  attempt.reference = local.reference;
  frame->times.local_map_ms = stopwatch.Lap_ms();
  proposer_.CountFrame();
  if (!attempt.succeeded) frame->placement = Placement();
  return attempt;
}

void LiveTracker::FollowMap(Motion* motion) {
  Placement& last = motion->last.placement;
  const MapId before = last.map();
  last.Follow(context_.map, *motion->last.seen, motion->velocity ? &*motion->velocity : nullptr);
  // The map has become part of another one: the directions are those of a world that is no more.
  if (last.map() != before) poses_.ForgetDirections();
}

void LiveTracker::Report(Frame* frame, KeyframeId reference, bool seek_others,
                         TrackerOutput* output) {
  const EarlierKeyframes& earlier = proposer_.earlier();
  std::optional<MapSeam> seam;
  if (seek_others && earlier.unanswered < options_.keyframes.max_unanswered_when_weak) {
    seam = seams_.Look(context_, *frame, proposer_.discarded_map(), rng_, &relocalizer_);
  }
  const bool is_keyframe =
      seam || IsKeyframe(*frame, reference, earlier, context_.map, options_.keyframes);
  if (is_keyframe) {
    KeyframeProposal proposal = proposer_.Propose(frame);
    proposer_.AddDiscardedMap(&proposal);
    proposer_.RestartCount();
    proposal.sightings = poses_.TakeSightings();
    if (seam) proposal.seam = *seam;
    output->keyframes.push_back(std::move(proposal));
  }
  output->poses.push_back(ReportPlaced(*frame));
  if (is_keyframe) output->poses.back().keyframe = frame->placement.reference;
}

// ---- Losing it ----

LiveState LiveTracker::Lose(Tracking now, Frame frame, TrackerOutput* output) {
  now.recent.Add(now.motion.last);
  Lost lost{NewInitializer(), now.motion.last.placement.map(), 0, {}};
  lost.pending.before_loss = now.recent.frames();
  lost.pending.Add(frame, options_.max_buffered_frames);
  return StayLost(std::move(lost), std::move(frame), output);
}

LiveState LiveTracker::StayLost(Lost now, Frame frame, TrackerOutput* output) {
  if (WantsNewMap(now)) return TryToStart(std::move(now), std::move(frame), output);
  ++now.frames_lost;
  output->poses.push_back(ReportUnplaced(frame, TrackingState::kLost, now.map));
  return now;
}

bool LiveTracker::WantsNewMap(const Lost& now) const {
  return now.frames_lost >= options_.relocalizer.frames_to_new_map;
}

void LiveTracker::TakeMapOver() {
  if (!proposer_.HasToTakeOver()) return;
  proposer_.TakeOver();
  const std::vector<MapId> maps = context_.map.Maps();
  if (maps.empty()) return;
  Lost lost{NewInitializer(), maps.back(), 0, {}};
  if (Starting* now = std::get_if<Starting>(&state_)) lost.pending = std::move(now->pending);
  if (Lost* now = std::get_if<Lost>(&state_)) lost.pending = std::move(now->pending);
  state_ = std::move(lost);
}

}  // namespace vpslam
