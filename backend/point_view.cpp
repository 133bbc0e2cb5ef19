#include "backend/point_view.h"

#include <algorithm>
#include <vector>

namespace vpslam {

void UpdateView(PointId id, const KeyframeStore& store, const ScalePyramid& scales, Map* map) {
  const MapPoint* point = map->Find(id);
  if (!point || point->observations.empty()) return;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  const Observation* reference = &point->observations.front();
  for (const Observation& o : point->observations) {
    normal += (map->Find(o.keyframe)->Center() - point->position).normalized();
    if (o.keyframe == point->reference) reference = &o;
  }
  const double distance = (map->Find(reference->keyframe)->Center() - point->position).norm();
  const int octave = store.at(reference->keyframe).features.keypoints[reference->feature].octave;
  const double max_distance = scales.MaxDistance(distance, octave);
  map->SetView(id, normal.normalized(), max_distance);
}

void UpdateDescriptor(PointId id, const KeyframeStore& store, Map* map) {
  // More observations hardly change the choice, but cost their square.
  constexpr size_t kMaxCompared = 12;
  const MapPoint* point = map->Find(id);
  if (!point || point->observations.empty()) return;
  std::vector<const Descriptor*> descriptors;
  const size_t n = point->observations.size();
  const size_t step = std::max<size_t>(1, n / kMaxCompared);
  for (size_t i = 0; i < n; i += step) {
    const Observation& o = point->observations[i];
    descriptors.push_back(&store.at(o.keyframe).features.descriptors[o.feature]);
  }
  int best_median = 257;
  const Descriptor* best = descriptors.front();
  std::vector<int> distances(descriptors.size());
  for (const Descriptor* candidate : descriptors) {
    std::transform(descriptors.begin(), descriptors.end(), distances.begin(),
                   [candidate](const Descriptor* other) { return Distance(*candidate, *other); });
    const auto middle = distances.begin() + static_cast<int>(distances.size() - 1) / 2;
    std::nth_element(distances.begin(), middle, distances.end());
    if (*middle < best_median) {
      best_median = *middle;
      best = candidate;
    }
  }
  map->SetDescriptor(id, *best);
}

}  // namespace vpslam
