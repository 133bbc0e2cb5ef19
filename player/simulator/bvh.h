// Bounding volume hierarchy over the quads of a scene, for shadow rays.
#pragma once

#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "player/simulator/scene.h"

namespace vpslam::simulator {

class Bvh {
 public:
  explicit Bvh(const std::vector<Quad>& quads);

  /// Whether a quad that casts shadows cuts the open segment from `from` to from + direction.
  bool Occluded(const Eigen::Vector3d& from, const Eigen::Vector3d& direction) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first = 0;  // of a leaf: its first quad; else: the second child, the first one is next
    int count = 0;  // quads of a leaf, 0 for an inner node
  };
  struct Item {
    Eigen::Vector3d origin, u, v;
  };
  void Build(int first, int count);

  std::vector<Item> items_;
  std::vector<Node> nodes_;
};

}  // namespace vpslam::simulator
