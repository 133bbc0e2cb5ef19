// Points with stable descriptors, cameras that look at them, and a map that agrees with both: what
// the stages of frontend and backend work on, with exact truth.
//
// A point has a size: it is found at octave 0 from its `max_distance`, and at a higher octave from
// nearer, as corners are. Key points err by as much as the pyramid says that they do.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "backend/mapping_context.h"
#include "core/features/feature_grid.h"
#include "core/features/features.h"
#include "core/features/scale_levels.h"
#include "core/geometry/camera.h"
#include "core/geometry/se3.h"
#include "core/map/map.h"
#include "core/map/owned_map.h"
#include "core/transport/codec.h"
#include "tests/unit/table_end.h"

namespace vpslam {

enum class SyntheticShape {
  kVolume,         ///< depths from 3 to 8
  kSlantedPlane,   ///< 35 degrees off the optical axis, 5 away in the middle
  kFrontoParallel  ///< a plane at depth 5
};

struct SyntheticOptions {
  SyntheticShape shape = SyntheticShape::kVolume;
  int num_points = 800;       ///< of which a camera near the origin sees about half
  double length = 8;          ///< of the scene, along x from -4
  int max_octave = 7;         ///< at which points are seen from about 5 away
  bool finest_only = false;   ///< all points are found on octave 0, from everywhere
  double noise_sigmas = 1;    ///< of key points, in the sigmas of their octaves
  int descriptor_bits = 8;    ///< that differ from the point's descriptor, per view
  double outlier_share = 0;   ///< features with the descriptor of a point that is elsewhere
  int clutter = 0;            ///< features that belong to no point, per view
  double detected_share = 1;  ///< of the points in view
};

struct SyntheticPoint {
  Eigen::Vector3d position;
  double max_distance = 0;
  Descriptor descriptor{};
  float angle_rad = 0;
};

struct SyntheticView {
  SE3 cam_from_world;
  Features features;
  FeatureGrid grid;
  std::vector<int> point;  ///< per feature: whose it is; -1 for outliers and clutter

  /// The feature that shows the point; -1 if none does.
  int FeatureOf(int p) const {
    const auto at = std::find(point.begin(), point.end(), p);
    return at == point.end() ? -1 : static_cast<int>(at - point.begin());
  }
};

/// A camera at `center` that looks along +z, turned by `turn` (rotation vector).
inline SE3 PoseAt(const Eigen::Vector3d& center,
                  const Eigen::Vector3d& turn = Eigen::Vector3d::Zero()) {
  const Eigen::Quaterniond rotation = ExpSo3(turn);
  return SE3(rotation, -(rotation * center));
}

class SyntheticScene {
 public:
  explicit SyntheticScene(uint64_t seed, const SyntheticOptions& options = {})
      : options_(options), rng_(seed) {
    camera.width = 640;
    camera.height = 480;
    camera.fx = camera.fy = 520;
    camera.cx = 320;
    camera.cy = 240;
    bounds = camera.UndistortedBounds();
    for (int i = 0; i < options.num_points; ++i) {
      SyntheticPoint p;
      p.position = {Uniform(-4, options.length - 4), Uniform(-3, 3), Uniform(3, 8)};
      if (options.shape != SyntheticShape::kVolume) p.position.z() = 5;
      if (options.shape == SyntheticShape::kSlantedPlane) p.position.z() += 0.7 * p.position.x();
      p.max_distance = 5 * scales.scale(static_cast<int>(Uniform(0, options.max_octave + 1)));
      p.descriptor = RandomDescriptor();
      p.angle_rad = static_cast<float>(Uniform(0, 2 * M_PI));
      points.push_back(p);
    }
  }

  Camera camera;
  Camera::Bounds bounds;
  ScalePyramid scales{8, 1.2, 0.9};
  std::vector<SyntheticPoint> points;

  /// What the camera sees from there; noise differs from call to call.
  SyntheticView Look(const SE3& cam_from_world) {
    SyntheticView view;
    view.cam_from_world = cam_from_world;
    for (size_t i = 0; i < points.size(); ++i) {
      const SyntheticPoint& p = points[i];
      const Eigen::Vector3d x = cam_from_world * p.position;
      if (x.z() < 0.3 || Uniform(0, 1) >= options_.detected_share) continue;
      const double distance = options_.finest_only ? p.max_distance : x.norm();
      if (distance > 1.1 * p.max_distance || 1.1 * distance < scales.MinDistance(p.max_distance)) {
        continue;
      }
      const int octave = scales.PredictOctave(distance, p.max_distance);
      const double sigma_px = options_.noise_sigmas * scales.sigma_px(octave);
      Eigen::Vector2d px = camera.Project(x) + sigma_px * Eigen::Vector2d(Normal(), Normal());
      const bool outlier = Uniform(0, 1) < options_.outlier_share;
      if (outlier) px += Eigen::Vector2d(Uniform(15, 60), Uniform(-60, 60));
      if (!bounds.Contains(px)) continue;
      Add(px, p.angle_rad, octave, Flipped(p.descriptor), &view);
      view.point.push_back(outlier ? -1 : static_cast<int>(i));
    }
    for (int i = 0; i < options_.clutter; ++i) {
      Add({Uniform(0, 639), Uniform(0, 479)}, static_cast<float>(Uniform(0, 6)),
          static_cast<int>(Uniform(0, options_.max_octave + 1)), RandomDescriptor(), &view);
      view.point.push_back(-1);
    }
    view.grid = FeatureGrid(view.features.keypoints, bounds);
    return view;
  }

  double Uniform(double low, double high) {
    return low + (high - low) * static_cast<double>(rng_() >> 11) * 0x1p-53;
  }
  double Normal() {
    const double radius = std::sqrt(-2 * std::log(1 - Uniform(0, 1)));
    return radius * std::cos(Uniform(0, 2 * M_PI));
  }
  Eigen::Vector3d NormalVector(double sigma) {
    const double x = Normal(), y = Normal(), z = Normal();
    return sigma * Eigen::Vector3d(x, y, z);
  }
  /// The pose, a bit off.
  SE3 Disturbed(const SE3& pose, double sigma, double sigma_rad) {
    Vector6d xi;
    xi << NormalVector(sigma), NormalVector(sigma_rad);
    return Retract(pose, xi);
  }

 private:
  static void Add(const Eigen::Vector2d& px, float angle_rad, int octave,
                  const Descriptor& descriptor, SyntheticView* view) {
    Keypoint k;
    k.x_px = static_cast<float>(px.x());
    k.y_px = static_cast<float>(px.y());
    k.angle_rad = angle_rad;
    k.octave = octave;
    view->features.keypoints.push_back(k);
    view->features.descriptors.push_back(descriptor);
  }
  Descriptor RandomDescriptor() { return {rng_(), rng_(), rng_(), rng_()}; }
  Descriptor Flipped(Descriptor d) {
    for (int i = 0; i < options_.descriptor_bits; ++i) {
      const uint64_t bit = rng_() % 256;
      d[bit / 64] ^= uint64_t{1} << (bit % 64);
    }
    return d;
  }

  SyntheticOptions options_;
  std::mt19937_64 rng_;
};

/// A map built by hand from views of a scene.
class SyntheticMap {
 public:
  explicit SyntheticMap(const SyntheticScene& scene) : scene_(scene) {}

  OwnedMap map;
  std::map<KeyframeId, SyntheticView> views;
  std::map<PointId, int> truth;  ///< points of the scene
  MapId map_id{0};               ///< of what is added

  /// At `cam_from_world`, which need not be where the view was taken. Hangs on the keyframe before.
  KeyframeId AddKeyframe(const SyntheticView& view, const SE3& cam_from_world) {
    Keyframe keyframe;
    keyframe.id = KeyframeId(KeyframeEnd(map));
    keyframe.map = map_id;
    keyframe.frame_seq = 10 * keyframe.id.value;
    keyframe.cam_from_world = cam_from_world;
    const KeyframeId before(keyframe.id.value - 1);
    if (map.Find(before) && map.Find(before)->map == map_id) keyframe.parent = before;
    keyframe.points.resize(view.features.size());
    keyframe.seen = FrameObservation::Make(keyframe.frame_seq, 0, view.features, scene_.bounds,
                                           std::make_shared<LineSet>());
    map.Insert(keyframe);
    views[keyframe.id] = view;
    return keyframe.id;
  }
  KeyframeId AddKeyframe(const SyntheticView& view) {
    return AddKeyframe(view, view.cam_from_world);
  }
  /// What the keyframe saw, which nobody but a test may change.
  Features& FeaturesOf(KeyframeId id) {
    return const_cast<Features&>(map.Find(id)->seen->features);
  }
  LineSet& LinesOf(KeyframeId id) { return const_cast<LineSet&>(*map.Find(id)->seen->lines); }
  MappingContext Context() { return {scene_.camera, scene_.bounds, scene_.scales, map}; }

  /// Point `p` of the scene at `position`, observed by those of the keyframes that show it; invalid
  /// if fewer than two do.
  PointId AddPoint(int p, const Eigen::Vector3d& position,
                   const std::vector<KeyframeId>& keyframes) {
    std::vector<KeyframeId> observers;
    for (const KeyframeId k : keyframes) {
      if (views.at(k).FeatureOf(p) >= 0) observers.push_back(k);
    }
    if (observers.size() < 2) return PointId();
    const PointId id = map.CreatePoint(map_id, observers.front(), position);
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (const KeyframeId k : observers) {
      map.Observe(k, views.at(k).FeatureOf(p), id);
      normal += (map.Find(k)->Center() - position).normalized();
    }
    map.SetView(id, normal.normalized(), scene_.points[p].max_distance);
    map.SetDescriptor(id, scene_.points[p].descriptor);
    truth[id] = p;
    return id;
  }
  PointId AddPoint(int p, const std::vector<KeyframeId>& keyframes) {
    return AddPoint(p, scene_.points[p].position, keyframes);
  }
  /// Points [begin, end) of the scene, as far as two of all keyframes show them.
  void AddPoints(int begin, int end) {
    std::vector<KeyframeId> all;
    for (const auto& [id, view] : views) all.push_back(id);
    for (int p = begin; p < end; ++p) AddPoint(p, all);
  }

 private:
  const SyntheticScene& scene_;
};

/// All that a map holds, as it travels: equal bytes, equal maps.
inline std::string BytesOf(const std::vector<MapDelta>& deltas) {
  std::string bytes;
  for (MapDelta delta : deltas) {
    delta.times = MappingTimes();
    const std::vector<uint8_t> encoded = Encode(Header(), delta);
    bytes.append(encoded.begin(), encoded.end());
  }
  return bytes;
}

}  // namespace vpslam
