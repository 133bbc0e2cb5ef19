#include "frontend/late_tracker.h"

#include <algorithm>

#include "frontend/line_tracking.h"
#include "frontend/local_map.h"

namespace vpslam {
namespace {

// After so many failures in a row the walk has left what the map shows, and ends.
constexpr int kMaxFailures = 3;

}  // namespace

void LateTracker::Start(std::vector<Frame> frames, const Frame& first, int64_t second_seq) {
  Walk backwards, between;
  backwards.last = between.last = first;
  for (Frame& frame : frames) {
    if (frame.seq() < first.seq()) {
      backwards.todo.push_front(std::move(frame));
    } else if (frame.seq() > first.seq() && frame.seq() < second_seq) {
      between.todo.push_back(std::move(frame));
    }
  }
  walks_.push_back(std::move(between));
  walks_.push_back(std::move(backwards));
}

void LateTracker::Return(std::vector<Frame> frames, const Frame& found) {
  Walk back;
  back.last = found;
  for (Frame& frame : frames) {
    if (frame.seq() < found.seq()) back.todo.push_front(std::move(frame));
  }
  walks_.push_back(std::move(back));
}

bool LateTracker::Place(const TrackingContext& context, const Walk& walk, Frame* frame) const {
  const SE3& last = walk.last.placement.cam_from_world;
  const SE3 predicted = walk.has_velocity ? walk.velocity * last : last;
  const auto& motion = options_.motion;
  int matches = MatchLastFrame(context, walk.last, predicted, motion.window_px, motion, frame);
  if (matches < motion.min_matches) {
    matches = MatchLastFrame(context, walk.last, last, 2 * motion.window_px, motion, frame);
  }
  if (matches < motion.min_matches) return false;
  if (OptimizeFrame(context, options_.pose, frame) < motion.min_inliers) return false;
  const LocalMap local = CollectLocalMap(context.map, *frame, options_.local_map);
  std::vector<PointId> visible;
  MatchLocalMap(context, local, options_.local_map, 1.0, frame, &visible);
  MatchLines(context, local.lines, options_.lines.window_px, options_.lines, frame);
  OptimizeFrame(context, options_.pose, frame);
  if (frame->placement.Support() < options_.local_map.min_inliers) return false;
  return frame->placement.HangOn(context.map, local.reference);
}

std::optional<Frame> LateTracker::Step(const TrackingContext& context) {
  while (!walks_.empty() && walks_.front().todo.empty()) walks_.erase(walks_.begin());
  if (walks_.empty()) return std::nullopt;
  Walk& walk = walks_.front();
  // The map moves while the walk goes on.
  if (!walk.last.placement.Follow(context.map, *walk.last.seen, &walk.velocity)) {
    walk.todo.clear();
    return std::nullopt;
  }
  Frame frame = std::move(walk.todo.front());
  walk.todo.pop_front();
  if (!Place(context, walk, &frame)) {
    if (++walk.failures >= kMaxFailures) walk.todo.clear();
    return std::nullopt;
  }
  walk.failures = 0;
  ++walk.frames_since_keyframe;
  walk.velocity = frame.placement.cam_from_world * walk.last.placement.cam_from_world.Inverse();
  walk.has_velocity = true;
  walk.last = frame;
  return frame;
}

void LateTracker::GoOnFrom(const Frame& keyframe) {
  walks_.front().last = keyframe;
  walks_.front().frames_since_keyframe = 0;
}

}  // namespace vpslam
