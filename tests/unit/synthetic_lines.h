// Straight edges for a synthetic scene, and the segments that its views show of them: what the
// stages of line mapping and tracking work on, with exact truth.
//
// Of an edge every view shows another part. Ends err across the line by as much as
// core/estimation/line_residual.h says that they do, and along it freely.
#pragma once

#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/estimation/line_residual.h"
#include "core/features/line_set.h"
#include "core/geometry/camera.h"
#include "core/geometry/so3.h"
#include "tests/unit/synthetic_scene.h"

namespace vpslam {

struct SyntheticLineOptions {
  int num_free = 60;     ///< of any direction
  int num_per_axis = 0;  ///< along each axis of the Manhattan frame; their segments are labelled
  double near = 3, far = 8;
  double noise_sigmas = 1;  ///< of end points across the line
  double cut_share = 0.15;  ///< of its length that a view may miss at either end
  int descriptor_bits = 8;  ///< that differ from the line's descriptor, per view
};

struct SyntheticLine {
  Eigen::Vector3d start, end;
  Descriptor descriptor{};
  int axis = -1;
};

struct SyntheticSegments {
  LineSet set;
  std::vector<int> line;  ///< per segment: what it shows

  int SegmentOf(int l) const {
    for (size_t i = 0; i < line.size(); ++i) {
      if (line[i] == l) return static_cast<int>(i);
    }
    return -1;
  }
};

class SyntheticLines {
 public:
  SyntheticLines(uint64_t seed, const SyntheticLineOptions& options = {})
      : options_(options), rng_(seed) {
    const auto place = [&] {
      const double x = Uniform(-3, 5), y = Uniform(-2, 2), z = Uniform(options.near, options.far);
      return Eigen::Vector3d(x, y, z);
    };
    for (int i = 0; i < options.num_free; ++i) {
      const double x = Uniform(-1, 1), y = Uniform(-1, 1), z = Uniform(-0.5, 0.5);
      Add(place(), Eigen::Vector3d(x, y, z).normalized(), -1);
    }
    for (int axis = 0; axis < 3; ++axis) {
      for (int i = 0; i < options.num_per_axis; ++i) {
        Add(place(), world_from_manhattan.toRotationMatrix().col(axis), axis);
      }
    }
  }

  const Eigen::Quaterniond world_from_manhattan = ExpSo3({0.15, 0.4, 0.1});
  std::vector<SyntheticLine> lines;

  /// Of length 0.8 to 2 through the point.
  int Add(const Eigen::Vector3d& middle, const Eigen::Vector3d& direction, int axis) {
    SyntheticLine line;
    const double half = Uniform(0.4, 1);
    line.start = middle - half * direction;
    line.end = middle + half * direction;
    line.axis = axis;
    line.descriptor = {rng_(), rng_(), rng_(), rng_()};
    lines.push_back(line);
    return static_cast<int>(lines.size()) - 1;
  }

  /// What a camera sees from there; noise differs from call to call.
  SyntheticSegments Look(const Camera& camera, const SE3& cam_from_world) {
    constexpr float kDetectorSigma_px = 0.5f;
    const Camera::Bounds bounds = camera.UndistortedBounds();
    SyntheticSegments seen;
    for (size_t l = 0; l < lines.size(); ++l) {
      const double from = Uniform(0, options_.cut_share), to = 1 - Uniform(0, options_.cut_share);
      const Eigen::Vector3d along = lines[l].end - lines[l].start;
      const Eigen::Vector3d a = cam_from_world * (lines[l].start + from * along);
      const Eigen::Vector3d b = cam_from_world * (lines[l].start + to * along);
      const double sigma_px = options_.noise_sigmas * LineSigma_px(kDetectorSigma_px);
      const double ea = sigma_px * Normal(), eb = sigma_px * Normal();
      const Descriptor descriptor = Flipped(lines[l].descriptor);
      if (a.z() < 0.3 || b.z() < 0.3) continue;
      const Eigen::Vector2d a_px = camera.Project(a), b_px = camera.Project(b);
      if (!bounds.Contains(a_px) || !bounds.Contains(b_px) || (b_px - a_px).norm() < 40) continue;
      const Eigen::Vector2d u = (b_px - a_px).normalized();
      const Eigen::Vector2d across(-u.y(), u.x());
      LineSegment segment;
      segment.start_px = (a_px + ea * across).cast<float>();
      segment.end_px = (b_px + eb * across).cast<float>();
      segment.sigma_px = kDetectorSigma_px;
      segment.descriptor = descriptor;
      segment.has_descriptor = true;
      segment.label = lines[l].axis;
      seen.set.lines.push_back(segment);
      seen.line.push_back(static_cast<int>(l));
    }
    if (options_.num_per_axis > 0) {
      seen.set.manhattan = ManhattanState::kThree;
      seen.set.cam_from_manhattan = cam_from_world.rotation * world_from_manhattan;
      seen.set.covariance_rad2 = 1e-5 * Eigen::Matrix3d::Identity();
      for (int axis = 0; axis < 3; ++axis) {
        VanishingPoint vp;
        vp.direction_in_cam = seen.set.cam_from_manhattan.toRotationMatrix().col(axis);
        vp.support = options_.num_per_axis;
        seen.set.vanishing_points.push_back(vp);
      }
    }
    return seen;
  }

  double Uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(rng_() >> 11) * 0x1p-53;
  }
  double Normal() {
    const double radius = std::sqrt(-2 * std::log(1 - Uniform(0, 1)));
    return radius * std::cos(Uniform(0, 2 * M_PI));
  }

 private:
  Descriptor Flipped(Descriptor d) {
    for (int i = 0; i < options_.descriptor_bits; ++i) {
      const uint64_t bit = rng_() % 256;
      d[bit / 64] ^= uint64_t{1} << (bit % 64);
    }
    return d;
  }

  SyntheticLineOptions options_;
  std::mt19937_64 rng_;
};

/// Keyframes of a scene with points and lines, at their true places. All points that two of them
/// show are in the map, no line is.
class SyntheticLineMap {
 public:
  SyntheticLineMap(uint64_t seed, const SyntheticLineOptions& options,
                   const std::vector<SE3>& poses,
                   const SyntheticOptions& points = {.num_points = 200})
      : scene(seed, points), lines(seed + 1000, options), map(scene) {
    for (const SE3& pose : poses) AddKeyframe(pose);
    map.AddPoints(0, static_cast<int>(scene.points.size()));
  }

  SyntheticScene scene;
  SyntheticLines lines;
  SyntheticMap map;
  std::map<KeyframeId, SyntheticSegments> segments;

  KeyframeId AddKeyframe(const SE3& pose) {
    const KeyframeId id = map.AddKeyframe(scene.Look(pose));
    segments[id] = lines.Look(scene.camera, pose);
    map.LinesOf(id) = segments[id].set;
    if (axes_.IsValid()) map.map.SetManhattanOf(id, axes_);
    return id;
  }
  KeyframeId last() const { return KeyframeId(KeyframeEnd(map.map) - 1); }
  LineSegment& Segment(KeyframeId k, int index) { return map.LinesOf(k).lines[index]; }

  /// Line `l` of the scene, at `start` and `end`, observed by those of the keyframes that show it;
  /// invalid if fewer than two do.
  LineId AddLine(int l, const Eigen::Vector3d& start, const Eigen::Vector3d& end,
                 const std::vector<KeyframeId>& keyframes) {
    std::vector<KeyframeId> observers;
    for (const KeyframeId k : keyframes) {
      if (segments.at(k).SegmentOf(l) >= 0) observers.push_back(k);
    }
    if (observers.size() < 2) return LineId();
    const LineId id = map.map.CreateLine(map.map_id, observers.front(), start, end);
    for (const KeyframeId k : observers) map.map.Observe(k, segments.at(k).SegmentOf(l), id);
    map.map.SetDescriptor(id, lines.lines[l].descriptor);
    SetAxisOf(id, lines.lines[l].axis);
    return id;
  }
  LineId AddLine(int l, const std::vector<KeyframeId>& keyframes) {
    return AddLine(l, lines.lines[l].start, lines.lines[l].end, keyframes);
  }
  /// The map gets a Manhattan frame, or its frame turns. All keyframes see its axes, and the lines
  /// have theirs.
  ManhattanId SetAxes(const Eigen::Quaterniond& world_from_manhattan) {
    if (axes_.IsValid()) {
      map.map.SetManhattan(axes_, world_from_manhattan);
      return axes_;
    }
    axes_ = map.map.CreateManhattan(map.map_id, world_from_manhattan);
    for (const auto& [id, seen] : segments) map.map.SetManhattanOf(id, axes_);
    for (const LineId id : Lines()) SetAxisOf(id, lines.lines[TruthOf(id)].axis);
    return axes_;
  }
  ManhattanId SetAxes() { return SetAxes(lines.world_from_manhattan); }
  std::vector<KeyframeId> AllKeyframes() const {
    std::vector<KeyframeId> all;
    for (const auto& [id, seen] : segments) all.push_back(id);
    return all;
  }
  /// Lines of the scene that at least `count` keyframes show.
  std::vector<int> SeenBy(int count) const {
    std::vector<int> result;
    for (int l = 0; l < static_cast<int>(lines.lines.size()); ++l) {
      int seen = 0;
      for (const auto& [id, view] : segments) seen += view.SegmentOf(l) >= 0;
      if (seen >= count) result.push_back(l);
    }
    return result;
  }
  /// The scene's line that the observations show; -1 if not all show the same.
  int TruthOf(LineId id) const {
    int truth = -2;
    for (const Observation& o : map.map.Find(id)->observations) {
      const int l = segments.at(o.keyframe).line[o.feature];
      if (truth != -2 && truth != l) return -1;
      truth = l;
    }
    return truth;
  }
  std::vector<LineId> Lines() const {
    std::vector<LineId> result;
    for (const MapLine& line : map.map.lines()) result.push_back(line.id);
    return result;
  }

 private:
  void SetAxisOf(LineId id, int axis) {
    if (axes_.IsValid() && axis >= 0) map.map.SetAxis(id, axes_, axis);
  }

  ManhattanId axes_;
};

/// Largest distance of the map line's ends from the true line.
inline double LineError(const MapLine& line, const SyntheticLine& truth) {
  const Eigen::Vector3d d = (truth.end - truth.start).normalized();
  return std::max(d.cross(line.start - truth.start).norm(), d.cross(line.end - truth.start).norm());
}

/// Cameras side by side, not on one line.
inline std::vector<SE3> PosesSideBySide(int count, double spacing = 0.35) {
  std::vector<SE3> poses;
  for (int i = 0; i < count; ++i) {
    poses.push_back(PoseAt({spacing * i, 0.25 * (i % 3) * spacing / 0.35, 0.05 * i},
                           {0.01 * (i % 2), -0.02 * i, 0}));
  }
  return poses;
}

}  // namespace vpslam
