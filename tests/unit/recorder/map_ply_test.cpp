#include "recorder/map_ply.h"

#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/map/owned_map.h"

namespace vpslam {
namespace {

Keyframe MakeKeyframe(int id, int map) {
  Keyframe keyframe;
  keyframe.id = KeyframeId(id);
  keyframe.map = MapId(map);
  keyframe.cam_from_world.translation = Eigen::Vector3d(-id, 0, 0);  // centre (id, 0, 0)
  return keyframe;
}

/// What follows the header, by line.
std::vector<std::string> Body(const std::string& ply) {
  std::istringstream in(ply.substr(ply.find("end_header\n") + 11));
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

TEST(MapPly, HoldsPointsKeyframesAndLinesOfOneMap) {
  OwnedMap map;
  for (int i = 0; i < 3; ++i) map.Insert(MakeKeyframe(i, i == 2 ? 1 : 0));
  map.CreatePoint(MapId(0), KeyframeId(0), {1, 2, -0.0});
  const PointId erased = map.CreatePoint(MapId(0), KeyframeId(0), {9, 9, 9});
  map.CreatePoint(MapId(1), KeyframeId(2), {7, 7, 7});
  map.CreateLine(MapId(0), KeyframeId(0), {0.5, 0, 1}, {0.5, 2, 1});
  const LineId gone = map.CreateLine(MapId(0), KeyframeId(0), {8, 8, 8}, {9, 9, 9});
  map.CreateLine(MapId(1), KeyframeId(2), {6, 6, 6}, {7, 7, 7});
  map.CreateLine(MapId(0), KeyframeId(0), {3, 0, 1}, {4, 0, 1});
  map.Erase(erased);
  map.Erase(gone);
  const std::string ply = MapPly(map, MapId(0));
  EXPECT_EQ(ply.rfind("ply\nformat ascii 1.0\n", 0), 0u);
  EXPECT_NE(ply.find("\nelement vertex 7\n"), std::string::npos);
  EXPECT_NE(ply.find("\nelement edge 2\n"), std::string::npos);
  const std::vector<std::string> expected = {"1 2 0 160 160 160",
                                             "0 0 0 220 40 40",
                                             "1 0 0 220 40 40",
                                             "0.5 0 1 40 80 220",
                                             "0.5 2 1 40 80 220",
                                             "3 0 1 40 80 220",
                                             "4 0 1 40 80 220",
                                             "3 4",
                                             "5 6"};
  EXPECT_EQ(Body(ply), expected);
}

TEST(MapPly, AnEmptyMapIsAFileToo) {
  const std::string ply = MapPly(Map(), MapId(0));
  EXPECT_NE(ply.find("\nelement vertex 0\n"), std::string::npos);
  EXPECT_NE(ply.find("\nelement edge 0\n"), std::string::npos);
  EXPECT_TRUE(Body(ply).empty());
}

}  // namespace
}  // namespace vpslam
