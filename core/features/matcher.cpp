#include "core/features/matcher.h"

#include <algorithm>

#include "core/geometry/chi_square.h"

namespace vpslam {
namespace {

constexpr int kFarthest = 256;  // no distance is larger

/// Best and second best of the candidates offered; the first of equal ones wins.
struct TwoBest {
  int index = -1;
  int distance = kFarthest + 1;
  int second_index = -1;
  int second_distance = kFarthest + 1;

  void Offer(int candidate, int d) {
    if (d < distance) {
      second_index = index;
      second_distance = distance;
      index = candidate;
      distance = d;
    } else if (d < second_distance) {
      second_index = candidate;
      second_distance = d;
    }
  }
  bool Passes(int max_distance, float ratio) const {
    return index >= 0 && distance <= max_distance &&
           (second_index < 0 ||
            static_cast<float>(distance) < ratio * static_cast<float>(second_distance));
  }
};

}  // namespace

void KeepRotationConsistent(const Features& first, const Features& second,
                            const RotationConsistencyOptions& options,
                            std::vector<Match>* matches) {
  std::vector<float> differences_rad;
  differences_rad.reserve(matches->size());
  for (const Match& m : *matches) {
    differences_rad.push_back(second.keypoints[m.second].angle_rad -
                              first.keypoints[m.first].angle_rad);
  }
  const std::vector<uint8_t> kept = FindRotationConsistent(differences_rad, options);
  size_t end = 0;
  for (size_t i = 0; i < matches->size(); ++i) {
    if (kept[i]) (*matches)[end++] = (*matches)[i];
  }
  matches->resize(end);
}

std::vector<Match> MatchForInitialisation(const Features& first, const Features& second,
                                          const FeatureGrid& second_grid,
                                          std::span<const Eigen::Vector2f> predicted_px,
                                          const InitialisationMatchOptions& options) {
  // Per second feature: who holds it, and at what distance. A nearer one takes it over.
  std::vector<int32_t> holder(second.size(), -1);
  std::vector<int> held_distance(second.size(), kFarthest + 1);
  for (int i = 0; i < first.size(); ++i) {
    const int octave = first.keypoints[i].octave;
    const OctaveRange octaves{octave - 1, octave + 1};
    TwoBest best;
    second_grid.ForEachInRadius(
        predicted_px[i].x(), predicted_px[i].y(), options.window_px, octaves,
        [&](int j) { best.Offer(j, Distance(first.descriptors[i], second.descriptors[j])); });
    // What is held by a better match is no candidate any more; but it is a rival all the same: of a
    // row of bars the next one must not win because the right one is taken.
    if (!best.Passes(options.max_distance, options.ratio) ||
        best.distance >= held_distance[best.index]) {
      continue;
    }
    holder[best.index] = i;
    held_distance[best.index] = best.distance;
  }
  std::vector<Match> matches;
  for (int j = 0; j < second.size(); ++j) {
    if (holder[j] >= 0) matches.push_back({holder[j], j});
  }
  std::sort(matches.begin(), matches.end(),
            [](const Match& a, const Match& b) { return a.first < b.first; });
  if (options.check_rotation) KeepRotationConsistent(first, second, options.rotation, &matches);
  return matches;
}

std::optional<WindowMatch> BestMatchInWindow(const Descriptor& descriptor, const WindowQuery& query,
                                             const Features& features, const FeatureGrid& grid,
                                             std::span<const uint8_t> taken) {
  TwoBest best;
  grid.ForEachInRadius(query.x_px, query.y_px, query.radius_px, query.octaves, [&](int i) {
    if (!taken.empty() && taken[i]) return;
    if (query.accuracy) {
      const Keypoint& k = features.keypoints[i];
      const double dx = k.x_px - query.x_px, dy = k.y_px - query.y_px;
      if (dx * dx + dy * dy > kChi2Dof2 * query.accuracy->sigma2(k.octave)) return;
    }
    best.Offer(i, Distance(descriptor, features.descriptors[i]));
  });
  if (best.index < 0 || best.distance > query.max_distance) return std::nullopt;
  const bool comparable =
      best.second_index >= 0 &&
      features.keypoints[best.index].octave == features.keypoints[best.second_index].octave;
  if (comparable && query.ratio < 1.0f && !best.Passes(query.max_distance, query.ratio)) {
    return std::nullopt;
  }
  return WindowMatch{best.index, best.distance, std::min(best.second_distance, kFarthest)};
}

std::vector<Match> MatchByDescriptor(std::span<const Descriptor> first,
                                     std::span<const Descriptor> second,
                                     const DescriptorMatchOptions& options) {
  // One pass over all pairs serves both directions.
  std::vector<int> best_first(second.size(), -1);
  std::vector<int> best_first_distance(second.size(), kFarthest + 1);
  std::vector<TwoBest> best_second(first.size());
  for (size_t i = 0; i < first.size(); ++i) {
    const Descriptor a = first[i];
    TwoBest best;
    for (size_t j = 0; j < second.size(); ++j) {
      const int d = Distance(a, second[j]);
      best.Offer(static_cast<int>(j), d);
      if (d < best_first_distance[j]) {
        best_first_distance[j] = d;
        best_first[j] = static_cast<int>(i);
      }
    }
    best_second[i] = best;
  }
  std::vector<Match> matches;
  for (size_t i = 0; i < first.size(); ++i) {
    const TwoBest& best = best_second[i];
    if (best.Passes(options.max_distance, options.ratio) &&
        best_first[best.index] == static_cast<int>(i)) {
      matches.push_back({static_cast<int32_t>(i), best.index});
    }
  }
  return matches;
}

}  // namespace vpslam
