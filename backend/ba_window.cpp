#include "backend/ba_window.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace vpslam {

BaWindow ChooseBaWindow(KeyframeId id, const LocalBaOptions& options, const Map& map) {
  BaWindow window;
  int observations = 0;
  const auto move = [&](KeyframeId keyframe) {
    window.moved.insert(keyframe);
    for (const PointId point : map.Find(keyframe)->points) observations += point.IsValid();
  };
  const auto is_full = [&](const std::set<KeyframeId>& group, int usual) {
    const double mean_points = observations / static_cast<double>(window.moved.size());
    const double growth =
        std::pow(options.plenty_points / std::max(1.0, mean_points), options.growth_power);
    return static_cast<double>(group.size()) >= usual * std::clamp(growth, 1.0, options.max_growth);
  };
  move(id);
  for (const auto& [other, shared] : map.Covisible(id, options.min_shared_points)) {
    if (is_full(window.moved, options.max_keyframes)) break;
    move(other);
  }
  std::map<KeyframeId, int> others;
  const auto add = [&](const auto& ids, auto* chosen) {
    for (const auto landmark_id : ids) {
      const auto* landmark = map.Find(landmark_id);
      if (!landmark || !chosen->insert(landmark_id).second) continue;
      for (const Observation& o : landmark->observations) {
        if (!window.moved.contains(o.keyframe)) ++others[o.keyframe];
      }
    }
  };
  for (const KeyframeId keyframe : window.moved) {
    add(map.Find(keyframe)->points, &window.points);
    add(map.Find(keyframe)->lines, &window.lines);
  }
  std::vector<std::pair<int, KeyframeId>> ranked;
  for (const auto& [other, count] : others) ranked.emplace_back(-count, other);
  std::sort(ranked.begin(), ranked.end());
  for (const auto& [count, other] : ranked) {
    if (is_full(window.fixed, options.max_fixed_keyframes)) break;
    window.fixed.insert(other);
  }
  // Without others to measure from, the oldest hold the gauge. The keyframe itself is moved always.
  for (auto at = window.moved.begin(); at != window.moved.end();) {
    if (static_cast<int>(window.fixed.size()) >= options.min_fixed_keyframes) break;
    if (*at == id) {
      ++at;
      continue;
    }
    window.fixed.insert(*at);
    at = window.moved.erase(at);
  }
  return window;
}

}  // namespace vpslam
