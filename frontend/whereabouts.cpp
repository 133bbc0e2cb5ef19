#include "frontend/whereabouts.h"

#include <algorithm>

#include "core/map/depth_quantile.h"

namespace vpslam {
namespace {

double ToSeconds(int64_t duration_us) { return 1e-6 * static_cast<double>(duration_us); }

}  // namespace

void Whereabouts::See(const Frame& frame) {
  constexpr int64_t kWindow_us = 1'000'000;
  sightings_.push_back({frame.stamp_us, frame.reference, frame.cam_from_reference});
  while (sightings_.front().stamp_us < frame.stamp_us - kWindow_us) sightings_.pop_front();
}

bool Whereabouts::Allow(const Map& map, MapId map_id, const SE3& cam_from_world,
                        int64_t stamp_us) const {
  constexpr double kMaxSpeedUp = 3;
  constexpr double kMaxDepthsPerSecond = 1;
  SE3 pose, last;
  const auto placed = [&](const Sighting& s, SE3* to) {
    return map.Place(s.reference, s.cam_from_reference, to) &&
           map.FindEvenCulled(s.reference)->map == map_id;
  };
  if (sightings_.empty() || !placed(sightings_.back(), &last)) return true;
  const int64_t seen_us = sightings_.back().stamp_us;
  double speed = 0;  // in map units per second
  for (const Sighting& s : sightings_) {
    const double duration_s = ToSeconds(seen_us - s.stamp_us);
    if (duration_s <= 0 || !placed(s, &pose)) continue;
    speed = (last.Center() - pose.Center()).norm() / duration_s;
    break;
  }
  const Keyframe* reference = map.Find(map.LivingAncestor(sightings_.back().reference));
  const double depth = reference ? DepthQuantile(map, reference->id, 0.5) : 0;
  const double max_speed = std::max(kMaxSpeedUp * speed, kMaxDepthsPerSecond * depth);
  return (cam_from_world.Center() - last.Center()).norm() <=
         max_speed * ToSeconds(stamp_us - seen_us);
}

}  // namespace vpslam
