#include "backend/point_view.h"

#include "backend/central_descriptor.h"

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
  const MapPoint* point = map->Find(id);
  if (!point || point->observations.empty()) return;
  map->SetDescriptor(id, CentralDescriptor(point->observations, [&](const Observation& o) {
                       return store.at(o.keyframe).features.descriptors[o.feature];
                     }));
}

}  // namespace vpslam
