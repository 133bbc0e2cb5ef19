#include "bench/micro/scene.h"

#include <random>
#include <stdexcept>

#include "player/source_factory.h"

namespace vpslam {
namespace {

constexpr int kImages = 4, kFramesApart = 5;
constexpr int kPointsPerMetre = 120, kLinesPerMetre = 30;
constexpr double kLength_m = 1.5;
constexpr double kStep_m = 0.05, kError_m = 0.01, kNoise_px = 1.0;
constexpr double kNear_m = 2, kFar_m = 6, kHalfHeight_m = 2.5, kHalfWidth_m = 3.5;

class Random {
 public:
  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(rng_);
  }
  Eigen::Vector2d Gauss2(double sigma) { return {sigma * normal_(rng_), sigma * normal_(rng_)}; }
  Eigen::Vector3d Gauss3(double sigma) {
    return {sigma * normal_(rng_), sigma * normal_(rng_), sigma * normal_(rng_)};
  }
  Descriptor Bits() { return {rng_(), rng_(), rng_(), rng_()}; }

 private:
  std::mt19937_64 rng_{1};
  std::normal_distribution<double> normal_;
};

}  // namespace

Camera SceneCamera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 500;
  camera.cx = 319.5;
  camera.cy = 239.5;
  return camera;
}

const SimulatedImages& Images() {
  static const SimulatedImages images = [] {
    cv::setNumThreads(1);
    SourceOptions options;
    options.max_frames = (kImages - 1) * kFramesApart + 1;
    const auto source = OpenSource("sim:room", options);
    SimulatedImages result;
    result.camera = source->camera();
    for (int i = 0; i < options.max_frames; ++i) {
      const auto frame = source->Next();
      if (!frame) throw std::runtime_error("sim:room ended early");
      if (i % kFramesApart != 0) continue;
      result.images.push_back(frame->grey);
      result.cam_from_world.push_back(source->WorldFromCam(frame->stamp_us)->Inverse());
    }
    return result;
  }();
  return images;
}

MapScene MakeMapScene(int num_keyframes, bool with_lines) {
  Random random;
  MapScene scene;
  scene.camera = SceneCamera();
  const Camera::Bounds bounds = scene.bounds = scene.camera.UndistortedBounds();
  const double length_m = kStep_m * num_keyframes;
  std::vector<Eigen::Vector3d> points;
  std::vector<PointId> ids;
  std::vector<Eigen::Vector3d> posts;  // upper ends of upright lines
  std::vector<LineId> line_ids;
  const int count = static_cast<int>(kPointsPerMetre * (length_m + 2 * kHalfWidth_m));
  for (int i = 0; i < count; ++i) {
    points.emplace_back(random.Uniform(-kHalfWidth_m, length_m + kHalfWidth_m),
                        random.Uniform(-kHalfHeight_m, kHalfHeight_m),
                        random.Uniform(kNear_m, kFar_m));
    ids.emplace_back();
    if (i * kLinesPerMetre / kPointsPerMetre == static_cast<int>(posts.size())) {
      posts.push_back(points.back());
      line_ids.emplace_back();
    }
  }
  const Eigen::Vector3d down(0, kLength_m, 0);
  for (int k = 0; k < num_keyframes; ++k) {
    const SE3 cam_from_world(Eigen::Quaterniond::Identity(), {-kStep_m * k, 0, 0});
    Features features;
    LineSet lines;
    std::vector<size_t> seen;
    for (size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector2d px =
          scene.camera.Project(cam_from_world * points[i]) + random.Gauss2(kNoise_px);
      if (!bounds.Contains(px)) continue;
      Keypoint keypoint;
      keypoint.x_px = static_cast<float>(px.x());
      keypoint.y_px = static_cast<float>(px.y());
      features.keypoints.push_back(keypoint);
      features.descriptors.push_back(random.Bits());
      seen.push_back(i);
    }
    std::vector<size_t> seen_lines;
    for (size_t i = 0; with_lines && i < posts.size(); ++i) {
      const Eigen::Vector2d start =
          scene.camera.Project(cam_from_world * posts[i]) + random.Gauss2(kNoise_px);
      const Eigen::Vector2d end =
          scene.camera.Project(cam_from_world * (posts[i] + down)) + random.Gauss2(kNoise_px);
      if (!bounds.Contains(start) || !bounds.Contains(end)) continue;
      LineSegment segment;
      segment.start_px = start.cast<float>();
      segment.end_px = end.cast<float>();
      segment.sigma_px = kNoise_px;
      lines.lines.push_back(segment);
      seen_lines.push_back(i);
    }
    Keyframe keyframe;
    keyframe.id = scene.last = KeyframeId(k);
    keyframe.map = MapId(0);
    keyframe.parent = KeyframeId(k - 1);
    keyframe.cam_from_world = cam_from_world;
    if (k > 1) keyframe.cam_from_world.translation += random.Gauss3(kError_m);
    keyframe.points.resize(seen.size());
    keyframe.lines.resize(seen_lines.size());
    keyframe.seen = FrameObservation::Make(k, 0, features, bounds,
                                           std::make_shared<const LineSet>(std::move(lines)));
    scene.map.Insert(keyframe);
    for (size_t f = 0; f < seen.size(); ++f) {
      PointId& id = ids[seen[f]];
      if (!id.IsValid()) {
        id =
            scene.map.CreatePoint(MapId(0), keyframe.id, points[seen[f]] + random.Gauss3(kError_m));
        scene.map.SetDescriptor(id, features.descriptors[f]);
        scene.map.SetView(id, Eigen::Vector3d::UnitZ(), kFar_m);
      }
      scene.map.Observe(keyframe.id, static_cast<int32_t>(f), id);
    }
    for (size_t f = 0; f < seen_lines.size(); ++f) {
      LineId& id = line_ids[seen_lines[f]];
      const Eigen::Vector3d& start = posts[seen_lines[f]];
      if (!id.IsValid()) {
        id = scene.map.CreateLine(MapId(0), keyframe.id, start + random.Gauss3(kError_m),
                                  start + down + random.Gauss3(kError_m));
      }
      scene.map.Observe(keyframe.id, static_cast<int32_t>(f), id);
    }
  }
  return scene;
}

PoseMeasurements MakeMeasurements(const Camera& camera, int count, int num_lines) {
  Random random;
  PoseMeasurements measurements;
  for (int i = 0; i < count; ++i) {
    PointMeasurement m;
    const Eigen::Vector2d px(random.Uniform(0, camera.width), random.Uniform(0, camera.height));
    m.point_in_world = random.Uniform(kNear_m, kFar_m) * camera.Unproject(px);
    m.px = px + random.Gauss2(kNoise_px);
    measurements.points.push_back(m);
  }
  for (int i = 0; i < num_lines; ++i) {
    LineMeasurement m;
    const auto end = [&](Eigen::Vector3d* in_world, Eigen::Vector2d* end_px) {
      const Eigen::Vector2d px(random.Uniform(0, camera.width), random.Uniform(0, camera.height));
      *in_world = random.Uniform(kNear_m, kFar_m) * camera.Unproject(px);
      *end_px = px + random.Gauss2(kNoise_px);
    };
    end(&m.start_in_world, &m.start_px);
    end(&m.end_in_world, &m.end_px);
    measurements.lines.push_back(m);
  }
  if (num_lines > 0) {
    measurements.rotation = {Eigen::Quaterniond::Identity(), 1e4 * Eigen::Matrix3d::Identity()};
  }
  return measurements;
}

}  // namespace vpslam
