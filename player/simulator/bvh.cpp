#include "player/simulator/bvh.h"

#include <algorithm>
#include <array>

namespace vpslam::simulator {
namespace {

constexpr int kLeafQuads = 4;

/// Möller and Trumbore, "Fast, minimum storage ray-triangle intersection" (1997), with the bounds
/// of a parallelogram. `direction` ends at parameter 1.
bool Hits(const Eigen::Vector3d& from, const Eigen::Vector3d& direction,
          const Eigen::Vector3d& origin, const Eigen::Vector3d& u, const Eigen::Vector3d& v) {
  const Eigen::Vector3d p = direction.cross(v);
  const double det = u.dot(p);
  if (std::abs(det) < 1e-14) return false;
  const Eigen::Vector3d s = from - origin;
  const double a = s.dot(p) / det;
  if (a < 0 || a > 1) return false;
  const Eigen::Vector3d q = s.cross(u);
  const double b = direction.dot(q) / det;
  if (b < 0 || b > 1) return false;
  const double t = v.dot(q) / det;
  return t > 1e-6 && t < 1 - 1e-6;
}

bool HitsBox(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& from,
             const Eigen::Vector3d& inverse) {
  const Eigen::Array3d t0 = (box.min() - from).array() * inverse.array();
  const Eigen::Array3d t1 = (box.max() - from).array() * inverse.array();
  return t0.min(t1).maxCoeff() <= std::min(1.0, t0.max(t1).minCoeff()) &&
         t0.max(t1).minCoeff() >= 0;
}

}  // namespace

Bvh::Bvh(const std::vector<Quad>& quads) {
  for (const Quad& q : quads) {
    if (q.casts_shadow) items_.push_back({q.origin, q.u, q.v});
  }
  if (!items_.empty()) Build(0, static_cast<int>(items_.size()));
}

void Bvh::Build(int first, int count) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Eigen::AlignedBox3d box, centres;
  for (int i = first; i < first + count; ++i) {
    const Item& q = items_[i];
    for (const Eigen::Vector3d& x :
         {q.origin, Eigen::Vector3d(q.origin + q.u), Eigen::Vector3d(q.origin + q.v),
          Eigen::Vector3d(q.origin + q.u + q.v)}) {
      box.extend(x);
    }
    centres.extend(q.origin + 0.5 * (q.u + q.v));
  }
  // A flat box would make 0 * infinity in HitsBox.
  box.min().array() -= 1e-9;
  box.max().array() += 1e-9;
  nodes_[index].box = box;
  if (count <= kLeafQuads) {
    nodes_[index].first = first;
    nodes_[index].count = count;
    return;
  }
  int axis = 0;
  centres.sizes().maxCoeff(&axis);
  const int half = count / 2;
  std::nth_element(items_.begin() + first, items_.begin() + first + half,
                   items_.begin() + first + count, [axis](const Item& a, const Item& b) {
                     return (a.origin + 0.5 * (a.u + a.v))[axis] <
                            (b.origin + 0.5 * (b.u + b.v))[axis];
                   });
  Build(first, half);
  nodes_[index].first = static_cast<int>(nodes_.size());
  Build(first + half, count - half);
}

bool Bvh::Occluded(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const {
  if (nodes_.empty()) return false;
  // A zero component would divide by zero; the tiny one bends the ray by nothing that shows.
  const Eigen::Vector3d inverse =
      direction.unaryExpr([](double d) { return 1 / (std::abs(d) > 1e-12 ? d : 1e-12); });
  std::array<int, 64> stack;
  int depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const int index = stack[--depth];
    const Node& node = nodes_[index];
    if (!HitsBox(node.box, from, inverse)) continue;
    if (node.count == 0) {
      stack[depth++] = node.first;
      stack[depth++] = index + 1;
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      if (Hits(from, direction, items_[i].origin, items_[i].u, items_[i].v)) return true;
    }
  }
  return false;
}

}  // namespace vpslam::simulator
