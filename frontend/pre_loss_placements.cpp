#include "frontend/pre_loss_placements.h"

#include <algorithm>

namespace vpslam {

void PreLossPlacements::Add(const std::deque<Frame>& frames) {
  frames_.insert(frames_.end(), frames.begin(), frames.end());
}

std::optional<MapSeam> PreLossPlacements::SeamAt(const Map& map, const Frame& placed) const {
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

const Frame* PreLossPlacements::Find(int64_t seq) const {
  const auto at = std::find_if(frames_.begin(), frames_.end(),
                               [&](const Frame& frame) { return frame.seq() == seq; });
  return at == frames_.end() ? nullptr : &*at;
}

}  // namespace vpslam
