#include "frontend/seam_finder.h"

#include <algorithm>
#include <vector>

namespace vpslam {

std::optional<MapSeam> SeamFinder::Look(const TrackingContext& context, const Frame& frame,
                                        MapId discarded, std::mt19937_64& rng,
                                        Relocalizer* relocalizer) {
  if (--frames_to_wait_ > 0) return std::nullopt;
  std::vector<MapId> except{frame.placement.map(), discarded};
  std::sort(except.begin(), except.end());
  const std::vector<MapId> maps = context.map.Maps();
  if (std::includes(except.begin(), except.end(), maps.begin(), maps.end())) return std::nullopt;
  frames_to_wait_ = options_.interval_frames;
  Frame elsewhere;
  elsewhere.seen = frame.seen;
  if (!relocalizer->Find(context, except, RelocalizationGate(), rng, &elsewhere))
    return std::nullopt;
  MapSeam seam;
  seam.map = elsewhere.placement.map();
  int common = 0;
  for (int i = 0; i < frame.seen->num_features(); ++i) {
    const MapPoint* point = context.map.Find(elsewhere.placement.points()[i]);
    if (!point) continue;
    seam.points.push_back({i, point->id});
    common += context.map.Find(frame.placement.points()[i]) != nullptr;
  }
  if (common < options_.min_common) return std::nullopt;
  seam.cam_from_world = elsewhere.placement.cam_from_world;
  frames_to_wait_ = options_.interval_after_seam_frames;
  return seam;
}

}  // namespace vpslam
