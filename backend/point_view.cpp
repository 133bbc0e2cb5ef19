#include "backend/point_view.h"

#include "backend/central_descriptor.h"

namespace vpslam {

void UpdateView(PointId id, const ScalePyramid& scales, OwnedMap* map) {
  const MapPoint* point = map->Find(id);
  if (!point || point->observations.empty()) return;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  const Observation* reference = &point->observations.front();
  for (const Observation& o : point->observations) {
    normal += (map->Find(o.keyframe)->Center() - point->position).normalized();
    if (o.keyframe == point->reference) reference = &o;
  }
  const Keyframe& seen_from = *map->Find(reference->keyframe);
  const double distance = (seen_from.Center() - point->position).norm();
  const int octave = seen_from.seen->features.keypoints[reference->feature].octave;
  const double max_distance = scales.MaxDistance(distance, octave);
  map->SetView(id, normal.normalized(), max_distance);
}

void UpdateDescriptor(PointId id, OwnedMap* map) {
  const MapPoint* point = map->Find(id);
  if (!point || point->observations.empty()) return;
  map->SetDescriptor(id, CentralDescriptor(point->observations, [&](const Observation& o) {
                       return map->Find(o.keyframe)->seen->features.descriptors[o.feature];
                     }));
}

}  // namespace vpslam
