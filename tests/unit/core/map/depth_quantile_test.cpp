#include "core/map/depth_quantile.h"

#include <vector>

#include <gtest/gtest.h>

#include "core/map/owned_map.h"

namespace vpslam {
namespace {

TEST(DepthQuantile, IsThatOfThePointsAsTheKeyframeSeesThem) {
  OwnedMap map;
  Keyframe keyframe;
  keyframe.id = KeyframeId(0);
  keyframe.map = MapId(0);
  keyframe.cam_from_world = SE3(Eigen::Quaterniond::Identity(), {0, 0, 1});
  keyframe.points.resize(7);
  map.Insert(keyframe);
  EXPECT_EQ(DepthQuantile(map, KeyframeId(0), 0.5), 0) << "no point yet";
  const std::vector<double> depths = {4, 8, 2, 9, 3};
  for (size_t i = 0; i < depths.size(); ++i) {
    const PointId id = map.CreatePoint(MapId(0), KeyframeId(0), {0, 0, depths[i] - 1});
    map.Observe(KeyframeId(0), static_cast<int32_t>(i), id);
  }
  EXPECT_DOUBLE_EQ(DepthQuantile(map, KeyframeId(0), 0), 2);
  EXPECT_DOUBLE_EQ(DepthQuantile(map, KeyframeId(0), 0.5), 4);
  EXPECT_DOUBLE_EQ(DepthQuantile(map, KeyframeId(0), 1), 9);
}

}  // namespace
}  // namespace vpslam
