#include "frontend/relocalization_gate.h"

#include <algorithm>

#include "core/map/depth_quantile.h"

namespace vpslam {
namespace {

double ToSeconds(int64_t duration_us) { return 1e-6 * static_cast<double>(duration_us); }

}  // namespace

void RelocalizationGate::See(const Frame& frame) {
  constexpr int64_t kWindow_us = 1'000'000;
  const int64_t stamp_us = frame.seen->stamp_us;
  while (!sightings_.empty() && sightings_.back().stamp_us >= stamp_us) sightings_.pop_back();
  sightings_.push_back({stamp_us, frame.placement.reference, frame.placement.cam_from_reference});
  while (sightings_.front().stamp_us < stamp_us - kWindow_us) sightings_.pop_front();
}

bool RelocalizationGate::Allow(const Map& map, MapId map_id, const SE3& cam_from_world,
                               int64_t stamp_us) const {
  constexpr double kMaxSpeedUp = 3;
  constexpr double kMaxDepthsPerSecond = 1;
  SE3 first, last;
  const auto place = [&map](const Sighting& s, SE3* to) {
    return map.Place(s.reference, s.cam_from_reference, to);
  };
  const auto latest = std::find_if(sightings_.rbegin(), sightings_.rend(),
                                   [&](const Sighting& s) { return place(s, &last); });
  if (latest == sightings_.rend() || latest->stamp_us >= stamp_us) return true;
  const auto is_there = [&](const Sighting& s) {
    return map.FindEvenCulled(s.reference)->map == map_id;
  };
  if (!is_there(*latest)) return true;
  const auto earliest = std::find_if(sightings_.begin(), sightings_.end(), [&](const Sighting& s) {
    return place(s, &first) && is_there(s);
  });
  const double duration_s = ToSeconds(latest->stamp_us - earliest->stamp_us);
  const double speed =  // in map units per second
      duration_s > 0 ? (last.Center() - first.Center()).norm() / duration_s : 0;
  const Keyframe* reference = map.Find(map.LivingAncestor(latest->reference));
  const double depth = reference ? DepthQuantile(map, reference->id, 0.5) : 0;
  const double max_speed = std::max(kMaxSpeedUp * speed, kMaxDepthsPerSecond * depth);
  return (cam_from_world.Center() - last.Center()).norm() <=
         max_speed * ToSeconds(stamp_us - latest->stamp_us);
}

}  // namespace vpslam
