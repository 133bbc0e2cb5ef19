#include "vpdetector/vp_lines.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace vpslam {

std::optional<VpLine> MakeVpLine(const Camera& camera, const Eigen::Vector2d& start_px,
                                 const Eigen::Vector2d& end_px, double sigma_px,
                                 double min_length_px) {
  const Eigen::Vector2d along = end_px - start_px;
  VpLine line;
  line.length_px = along.norm();
  if (!(line.length_px >= min_length_px) || !(line.length_px > 0)) return std::nullopt;
  const Eigen::Vector3d p = camera.Unproject(start_px), q = camera.Unproject(end_px);
  const Eigen::Vector3d cross = p.cross(q);
  const double size = cross.norm();
  if (!(size > 1e-12)) return std::nullopt;
  line.normal = cross / size;
  line.middle = 0.5 * (p + q).head<2>();
  line.direction = (q - p).head<2>().normalized();
  // One standard deviation across the segment, on the plane z = 1.
  const Eigen::Vector2d across = sigma_px / line.length_px * Eigen::Vector2d(-along.y(), along.x());
  const Eigen::Vector3d step(across.x() / camera.fx, across.y() / camera.fy, 0);
  line.noise_a = step.cross(q) / size;
  line.noise_b = p.cross(step) / size;
  return line;
}

std::vector<int32_t> GroupByInfiniteLine(const std::vector<Eigen::Vector2d>& starts_px,
                                         const std::vector<Eigen::Vector2d>& ends_px,
                                         double distance_px) {
  const size_t n = starts_px.size();
  std::vector<float> length(n);
  for (size_t i = 0; i < n; ++i) {
    length[i] = static_cast<float>((ends_px[i] - starts_px[i]).norm());
  }
  std::vector<int32_t> order(n), group(n, -1);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int32_t a, int32_t b) {
    return length[static_cast<size_t>(a)] > length[static_cast<size_t>(b)];
  });
  // Leaders so far as lines nx x + ny y + c = 0.
  std::vector<float> nx, ny, c;
  std::vector<int32_t> leader;
  const float limit = static_cast<float>(distance_px);
  for (const int32_t index : order) {
    const auto i = static_cast<size_t>(index);
    const Eigen::Vector2f a = starts_px[i].cast<float>(), b = ends_px[i].cast<float>();
    for (size_t k = 0; k < leader.size(); ++k) {
      if (std::abs(nx[k] * a.x() + ny[k] * a.y() + c[k]) <= limit &&
          std::abs(nx[k] * b.x() + ny[k] * b.y() + c[k]) <= limit) {
        group[i] = leader[k];
        break;
      }
    }
    if (group[i] >= 0) continue;
    group[i] = index;
    const Eigen::Vector2f d =
        length[i] > 0 ? Eigen::Vector2f((b - a) / length[i]) : Eigen::Vector2f::UnitX();
    leader.push_back(index);
    nx.push_back(-d.y());
    ny.push_back(d.x());
    c.push_back(d.y() * a.x() - d.x() * a.y());
  }
  return group;
}

}  // namespace vpslam
