#include "recorder/map_ply.h"

#include <iterator>

#include <fmt/format.h>

namespace vpslam {
namespace {

void AppendVertex(const Eigen::Vector3d& x, const char* colour, std::string* text) {
  // Adding zero turns -0 into 0.
  fmt::format_to(std::back_inserter(*text), "{:.7g} {:.7g} {:.7g} {}\n", x.x() + 0.0, x.y() + 0.0,
                 x.z() + 0.0, colour);
}

}  // namespace

std::string MapPly(const Map& map, MapId map_id) {
  std::string vertices;
  int count = 0;
  for (int32_t i = 0; i < map.point_end(); ++i) {
    const MapPoint* point = map.Find(PointId(i));
    if (!point || point->map != map_id) continue;
    AppendVertex(point->position, "160 160 160", &vertices);
    ++count;
  }
  for (int32_t i = 0; i < map.keyframe_end(); ++i) {
    const Keyframe* keyframe = map.Find(KeyframeId(i));
    if (!keyframe || keyframe->map != map_id) continue;
    AppendVertex(keyframe->Center(), "220 40 40", &vertices);
    ++count;
  }
  return fmt::format(
             "ply\nformat ascii 1.0\ncomment points grey, keyframes red\nelement vertex {}\n"
             "property float x\nproperty float y\nproperty float z\n"
             "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n",
             count) +
         vertices;
}

}  // namespace vpslam
