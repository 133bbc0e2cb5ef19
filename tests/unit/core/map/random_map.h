// A map that grows and shrinks at random, with seed, for tests.
#pragma once

#include <random>

#include "core/map/owned_map.h"
#include "tests/unit/table_end.h"

namespace vpslam {

class RandomMap {
 public:
  explicit RandomMap(uint32_t seed) : rng_(seed) {}

  OwnedMap map;
  MapId grows{0};  ///< the map that steps add to

  /// One keyframe more, with new points, and some that are fused, erased or moved.
  void Step() {
    Keyframe keyframe;
    keyframe.id = KeyframeId(next_++);
    keyframe.map = grows;
    keyframe.frame_seq = 10 * keyframe.id.value;
    for (const Keyframe& other : map.keyframes()) {
      if (other.map == grows) keyframe.parent = other.id;
    }
    keyframe.cam_from_world = SE3(ExpSo3(Vector()), Vector());
    keyframe.points.resize(kFeatures);
    for (PointId& point : keyframe.points) {
      if (EndOf(map.points()) > 0 && Below(2) == 0) point = PointId(Below(EndOf(map.points())));
      if (map.Find(point) && map.Find(point)->map != grows) point = PointId();
    }
    keyframe.lines.resize(kSegments);
    for (LineId& line : keyframe.lines) {
      if (EndOf(map.lines()) > 0 && Below(2) == 0) line = LineId(Below(EndOf(map.lines())));
      if (map.Find(line) && map.Find(line)->map != grows) line = LineId();
    }
    map.Insert(keyframe);
    for (int i = 0; i < kSegments; ++i) {
      if (map.Find(keyframe.id)->lines[i].IsValid()) continue;
      const LineId line = map.CreateLine(grows, keyframe.id, Vector(), Vector());
      if (const auto frames = map.ManhattanFrames(grows); !frames.empty() && Below(4) > 0) {
        map.SetAxis(line, frames[Below(static_cast<int>(frames.size()))].id, Below(3));
      }
      map.Observe(keyframe.id, i, line);
    }
    for (int i = 0; i < kFeatures; ++i) {
      if (map.Find(keyframe.id)->points[i].IsValid()) continue;
      const PointId point = map.CreatePoint(grows, keyframe.id, Vector());
      map.Observe(keyframe.id, i, point);
    }
    for (int i = 0; i < 4; ++i) {
      const PointId a(Below(EndOf(map.points()))), b(Below(EndOf(map.points())));
      if (map.Find(a) && map.Find(b) && map.Find(a)->map == map.Find(b)->map) map.Fuse(a, b);
      const PointId c(Below(EndOf(map.points())));
      if (map.Find(c)) map.SetPosition(c, Vector());
    }
    const LineId a(Below(EndOf(map.lines()))), b(Below(EndOf(map.lines())));
    if (map.Find(a) && map.Find(b) && map.Find(a)->map == map.Find(b)->map) map.Fuse(a, b);
    const LineId c(Below(EndOf(map.lines())));
    if (map.Find(c)) map.SetEnds(c, Vector(), Vector());
    ChangeAxes(keyframe.id);
    const KeyframeId culled(1 + Below(next_));
    if (keyframe.id.value > 3 && Below(3) == 0 && map.Find(culled)) map.Cull(culled);
    if (Below(5) == 0) map.Compact(map.version() - 10);
  }

 private:
  static constexpr int kFeatures = 30;
  static constexpr int kSegments = 8;
  /// A map has up to three Manhattan frames.
  void ChangeAxes(KeyframeId keyframe) {
    const std::vector<ManhattanAxes> frames = map.ManhattanFrames(grows);
    const int which = Below(3);
    if (which >= std::ssize(frames)) {
      map.SetManhattanOf(keyframe, map.CreateManhattan(grows, ExpSo3(Vector())));
    } else if (Below(4) == 0) {
      map.EraseManhattan(frames[which].id);
    } else {
      map.SetManhattan(frames[which].id, ExpSo3(Vector()));
      map.SetManhattanOf(keyframe, frames[which].id);
    }
  }
  int Below(int n) { return static_cast<int>(rng_() % static_cast<uint32_t>(n)); }
  Eigen::Vector3d Vector() {
    std::uniform_real_distribution<double> uniform(-1, 1);
    return {uniform(rng_), uniform(rng_), uniform(rng_)};
  }

  std::mt19937 rng_;
  int32_t next_ = 0;
};

}  // namespace vpslam
