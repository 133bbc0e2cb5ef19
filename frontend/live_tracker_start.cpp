// How a map is started, and proves itself or is given up.
#include <algorithm>
#include <type_traits>
#include <utility>

#include "core/base/stopwatch.h"
#include "frontend/live_tracker.h"
#include "frontend/pose_report.h"

namespace vpslam {
namespace {

FramePose ReportWaiting(const Starting&, const Frame& frame) {
  return ReportUnplaced(frame, TrackingState::kInitialising, MapId());
}
FramePose ReportWaiting(const Lost& lost, const Frame& frame) {
  return ReportUnplaced(frame, TrackingState::kLost, lost.map);
}

}  // namespace

Initializer LiveTracker::NewInitializer() const {
  return Initializer(context_.camera, context_.scales, options_.initializer);
}

template <class State>
LiveState LiveTracker::TryToStart(State now, Frame frame, TrackerOutput* output) {
  Stopwatch stopwatch;
  const std::optional<InitialMap> initial = now.initializer.Add(frame, rng_);
  frame.times.initial_pose_ms = stopwatch.Lap_ms();
  if (!initial) {
    output->poses.push_back(ReportWaiting(now, frame));
    return now;
  }
  OnProbation next = StartMap(*initial, std::move(frame), output);
  next.pending = std::move(now.pending);
  if constexpr (std::is_same_v<State, Lost>) next.frames_lost = now.frames_lost;
  return next;
}
template LiveState LiveTracker::TryToStart(Starting, Frame, TrackerOutput*);
template LiveState LiveTracker::TryToStart(Lost, Frame, TrackerOutput*);

OnProbation LiveTracker::StartMap(const InitialMap& initial, Frame second, TrackerOutput* output) {
  const MapId map = proposer_.NewMap();
  Frame first = initial.first;
  first.PlaceIn(map, SE3());
  second.PlaceIn(map, initial.second_from_first);
  for (Frame* view : {&first, &second}) {
    Placement& placement = view->placement;
    placement.inliers = placement.num_matches = static_cast<int>(initial.points.size());
    output->keyframes.push_back(proposer_.Propose(view));
  }
  KeyframeProposal &of_first = output->keyframes[0], &of_second = output->keyframes[1];
  of_first.role = KeyframeRole::kMapFirst;
  proposer_.AddDiscardedMap(&of_first);
  of_second.role = KeyframeRole::kMapSecond;
  of_second.initial_points = initial.points;
  output->poses.push_back(ReportPlaced(second));
  output->poses.back().keyframe = second.placement.reference;

  proposer_.RestartCount();
  poses_.TakeSightings();
  poses_.ForgetDirections();
  OnProbation next;
  next.first = std::move(first);
  next.second_seq = second.seq();
  next.motion.last = std::move(second);
  return next;
}

Tracking LiveTracker::PassProbation(OnProbation now, TrackerOutput* output) {
  output->poses.push_back(ReportPlacedLate(now.first));
  output->poses.back().keyframe = now.first.placement.reference;
  late_.PlaceAroundStart(now.pending, now.first, now.second_seq);
  return {std::move(now.motion), std::move(now.recent)};
}

LiveState LiveTracker::GiveMapUp(OnProbation now, Frame frame, TrackerOutput* output) {
  const MapId wrong = now.motion.last.placement.map();
  proposer_.DiscardMap(wrong);
  Initializer initializer = NewInitializer();
  constexpr size_t kFramesBack = 10;
  const std::deque<Frame>& frames = now.pending.frames;
  const size_t n = frames.size();
  if (n > 1) initializer.Add(frames[n - std::min(n, 1 + kFramesBack)], rng_);

  std::vector<MapId> others = context_.map.Maps();
  std::erase(others, wrong);
  if (others.empty()) {
    return TryToStart(Starting{std::move(initializer), std::move(now.pending)}, std::move(frame),
                      output);
  }
  return TryToStart(
      Lost{std::move(initializer), others.back(), now.frames_lost, std::move(now.pending)},
      std::move(frame), output);
}

void LiveTracker::Finish(TrackerOutput* output) {
  if (OnProbation* now = std::get_if<OnProbation>(&state_)) {
    state_ = PassProbation(std::move(*now), output);
  }
}

}  // namespace vpslam
