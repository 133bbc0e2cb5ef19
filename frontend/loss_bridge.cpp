#include "frontend/loss_bridge.h"

#include <algorithm>

#include "frontend/frame_tracking.h"

namespace vpslam {
namespace {

/// Of `before`, as it was tracked in the old map, and `after`, the same frame in the new one.
MapSeam MakeSeam(const Map& map, const Frame& before, const Frame& after, int* common) {
  MapSeam seam;
  *common = 0;
  if (!map.Place(before.reference, before.cam_from_reference, &seam.cam_from_world)) return seam;
  const MapId old = map.FindEvenCulled(before.reference)->map;
  if (old == map.FindEvenCulled(after.reference)->map) return seam;
  seam.map = old;
  for (int i = 0; i < before.features.size(); ++i) {
    const MapPoint* point = map.Find(map.Resolve(before.points[i]));
    if (!point || point->map != old) continue;
    seam.points.push_back({i, point->id});
    *common += map.Find(map.Resolve(after.points[i])) != nullptr;
  }
  return seam;
}

}  // namespace

void LossBridge::Keep(Frame frame) {
  // Half a second: farther back, the frames show another view, and the walk seldom gets there.
  constexpr size_t kMaxFrames = 15;
  kept_.push_back(std::move(frame));
  if (kept_.size() > kMaxFrames) kept_.pop_front();
}

void LossBridge::Break() {
  ForgetNearEnd();
  near_end_ = std::exchange(kept_, {});
}

void LossBridge::ForgetNearEnd() {
  near_end_.clear();
  best_.reset();
  best_common_ = 0;
}

std::vector<Frame> LossBridge::NearEnd() const {
  std::vector<Frame> frames(near_end_.begin(), near_end_.end());
  for (Frame& frame : frames) frame.ForgetMatches();
  return frames;
}

bool LossBridge::Offer(const Map& map, const Frame& placed) {
  const auto before = std::find_if(near_end_.begin(), near_end_.end(),
                                   [&](const Frame& f) { return f.seq == placed.seq; });
  if (before == near_end_.end()) return false;
  // A keyframe is in the old map, and cannot be in the new one as well.
  const Keyframe* reference = map.FindEvenCulled(before->reference);
  if (reference && reference->frame_seq == before->seq) return true;
  int common = 0;
  MakeSeam(map, *before, placed, &common);
  if (common > best_common_) {
    best_ = placed;
    best_common_ = common;
  }
  return true;
}

std::optional<std::pair<Frame, MapSeam>> LossBridge::Take(const Map& map) {
  if (!best_) return std::nullopt;
  const std::deque<Frame> near_end = std::exchange(near_end_, {});
  Frame frame = *std::exchange(best_, std::nullopt);
  best_common_ = 0;
  if (!FollowMap(map, &frame, nullptr)) return std::nullopt;
  const auto before = std::find_if(near_end.begin(), near_end.end(),
                                   [&](const Frame& f) { return f.seq == frame.seq; });
  int common = 0;
  const MapSeam seam = MakeSeam(map, *before, frame, &common);
  if (common < options_.min_common) return std::nullopt;
  return std::pair(std::move(frame), seam);
}

}  // namespace vpslam
