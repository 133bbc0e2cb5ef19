// A map that grows and shrinks at random, with seed, for tests.
#pragma once

#include <random>

#include "core/map/map.h"

namespace vpslam {

class RandomMap {
 public:
  explicit RandomMap(uint32_t seed) : rng_(seed) {}

  Map map;
  MapId grows{0};  ///< the map that steps add to

  /// One keyframe more, with new points, and some that are fused, erased or moved.
  void Step() {
    Keyframe keyframe;
    keyframe.id = KeyframeId(next_++);
    keyframe.map = grows;
    keyframe.frame_seq = 10 * keyframe.id.value;
    if (map.NumKeyframes(grows) > 0) {
      keyframe.parent = map.LivingAncestor(KeyframeId(keyframe.id.value - 1));
    }
    keyframe.cam_from_world = SE3(ExpSo3(Vector()), Vector());
    keyframe.points.resize(kFeatures);
    for (PointId& point : keyframe.points) {
      if (map.point_end() > 0 && Below(2) == 0) point = PointId(Below(map.point_end()));
      if (map.Find(point) && map.Find(point)->map != grows) point = PointId();
    }
    keyframe.lines.resize(kSegments);
    for (LineId& line : keyframe.lines) {
      if (map.line_end() > 0 && Below(2) == 0) line = LineId(Below(map.line_end()));
    }
    map.Insert(keyframe);
    for (int i = 0; i < kSegments; ++i) {
      if (map.Find(keyframe.id)->lines[i].IsValid()) continue;
      const LineId line = map.CreateLine(MapId(0), keyframe.id, Vector(), Vector());
      map.SetAxis(line, Below(4) - 1);
      map.Observe(keyframe.id, i, line);
    }
    for (int i = 0; i < kFeatures; ++i) {
      if (map.Find(keyframe.id)->points[i].IsValid()) continue;
      const PointId point = map.CreatePoint(grows, keyframe.id, Vector());
      map.Observe(keyframe.id, i, point);
    }
    for (int i = 0; i < 4; ++i) {
      const PointId a(Below(map.point_end())), b(Below(map.point_end()));
      if (map.Find(a) && map.Find(b) && map.Find(a)->map == map.Find(b)->map) map.Fuse(a, b);
      const PointId c(Below(map.point_end()));
      if (map.Find(c)) map.SetPosition(c, Vector());
    }
    const LineId a(Below(map.line_end())), b(Below(map.line_end()));
    if (map.Find(a) && map.Find(b)) map.Fuse(a, b);
    const LineId c(Below(map.line_end()));
    if (map.Find(c)) map.SetEnds(c, Vector(), Vector());
    map.SetManhattan(MapId(0), Below(3) == 0 ? std::nullopt : std::optional(ExpSo3(Vector())));
    if (keyframe.id.value > 3 && Below(3) == 0) map.Cull(KeyframeId(1 + Below(next_ - 1)));
  }

 private:
  static constexpr int kFeatures = 30;
  static constexpr int kSegments = 8;
  int Below(int n) { return static_cast<int>(rng_() % static_cast<uint32_t>(n)); }
  Eigen::Vector3d Vector() {
    std::uniform_real_distribution<double> uniform(-1, 1);
    return {uniform(rng_), uniform(rng_), uniform(rng_)};
  }

  std::mt19937 rng_;
  int32_t next_ = 0;
};

}  // namespace vpslam
