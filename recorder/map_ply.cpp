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
  for (const MapPoint& point : map.points()) {
    if (point.map != map_id) continue;
    AppendVertex(point.position, "160 160 160", &vertices);
    ++count;
  }
  for (const Keyframe& keyframe : map.keyframes()) {
    if (keyframe.map != map_id) continue;
    AppendVertex(keyframe.Center(), "220 40 40", &vertices);
    ++count;
  }
  std::string edges;
  int num_edges = 0;
  for (const MapLine& line : map.lines()) {
    if (line.map != map_id) continue;
    AppendVertex(line.start, "40 80 220", &vertices);
    AppendVertex(line.end, "40 80 220", &vertices);
    fmt::format_to(std::back_inserter(edges), "{} {}\n", count, count + 1);
    count += 2;
    ++num_edges;
  }
  return fmt::format(
             "ply\nformat ascii 1.0\ncomment points grey, keyframes red, ends of lines blue\n"
             "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
             "property uchar red\nproperty uchar green\nproperty uchar blue\n"
             "element edge {}\nproperty int vertex1\nproperty int vertex2\nend_header\n",
             count, num_edges) +
         vertices + edges;
}

}  // namespace vpslam
