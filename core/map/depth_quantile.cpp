#include "core/map/depth_quantile.h"

#include <algorithm>
#include <vector>

namespace vpslam {

double DepthQuantile(const Map& map, KeyframeId id, double quantile) {
  const Keyframe* keyframe = map.Find(id);
  std::vector<double> depths;
  for (const PointId point_id : keyframe->points) {
    if (const MapPoint* point = map.Find(point_id)) {
      depths.push_back((keyframe->cam_from_world * point->position).z());
    }
  }
  if (depths.empty()) return 0;
  const auto at =
      depths.begin() + static_cast<int>(quantile * static_cast<double>(depths.size() - 1));
  std::nth_element(depths.begin(), at, depths.end());
  return *at;
}

}  // namespace vpslam
