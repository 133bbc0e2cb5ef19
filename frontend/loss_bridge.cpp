#include "frontend/loss_bridge.h"

#include <algorithm>
#include <utility>

namespace vpslam {

void LossBridge::Keep(Frame frame) {
  // Some seconds. In a turn the old map is thin, and what both maps have comes before it.
  constexpr size_t kMaxFrames = 100;
  kept_.push_back(std::move(frame));
  if (kept_.size() > kMaxFrames) kept_.pop_front();
}

void LossBridge::Break() { near_end_ = std::exchange(kept_, {}); }

std::vector<Frame> LossBridge::Cross() {
  std::vector<Frame> frames(near_end_.begin(), near_end_.end());
  crossing_.insert(crossing_.end(), frames.begin(), frames.end());
  near_end_.clear();
  for (Frame& frame : frames) frame.placement = Placement();
  return frames;
}

std::optional<MapSeam> LossBridge::SeamAt(const Map& map, const Frame& placed) const {
  const Frame* frame = Find(placed.seq());
  if (!frame) return std::nullopt;
  const Placement& before = frame->placement;
  MapSeam seam;
  if (!map.Place(before.reference, before.cam_from_reference, &seam.cam_from_world)) {
    return std::nullopt;
  }
  seam.map = map.Resolve(before.map());
  if (seam.map == map.Resolve(placed.placement.map())) return std::nullopt;
  for (int i = 0; i < static_cast<int>(before.points().size()); ++i) {
    const MapPoint* point = map.Find(map.Resolve(before.points()[i]));
    if (point && point->map == seam.map) seam.points.push_back({i, point->id});
  }
  return seam;
}

const Frame* LossBridge::Find(int64_t seq) const {
  const auto at = std::find_if(crossing_.begin(), crossing_.end(),
                               [&](const Frame& f) { return f.seq() == seq; });
  return at == crossing_.end() ? nullptr : &*at;
}

}  // namespace vpslam
