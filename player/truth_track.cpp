#include "player/truth_track.h"

#include <iterator>

namespace vpslam {

std::optional<SE3> TruthTrack::Nearest(int64_t stamp_us, int64_t tolerance_us) const {
  if (poses_.empty()) return std::nullopt;
  auto best = poses_.lower_bound(stamp_us);
  if (best == poses_.end() ||
      (best != poses_.begin() && stamp_us - std::prev(best)->first <= best->first - stamp_us)) {
    best = std::prev(best);
  }
  const int64_t distance = best->first > stamp_us ? best->first - stamp_us : stamp_us - best->first;
  if (distance > tolerance_us) return std::nullopt;
  return best->second;
}

}  // namespace vpslam
