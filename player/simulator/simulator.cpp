#include "player/simulator/simulator.h"

#include <utility>

#include "player/simulator/random.h"

namespace vpslam::simulator {
namespace {

constexpr double kFps = 30;
constexpr int64_t kFirstStamp_us = 1'000'000;

/// A common webcam or depth camera's colour image, 640 x 480.
Camera MakeCamera(bool distortion) {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fps = kFps;
  camera.fx = 522.4;
  camera.fy = 521.6;
  camera.cx = 318.7;
  camera.cy = 241.3;
  if (distortion) {
    camera.k1 = -0.26;
    camera.k2 = 0.06;
    camera.p1 = 0.0003;
    camera.p2 = -0.0002;
  }
  return camera;
}

Place MakePlace(const Spec& spec) {
  return spec.scene == SceneKind::kRoom ? MakeRoom(spec.seed) : MakeCorridor(spec.seed);
}

SensorOptions MakeSensorOptions(const Spec& spec) {
  SensorOptions options;
  options.noise = spec.noise;
  return options;
}

}  // namespace

Simulator Simulator::Create(const std::string& spec) { return Simulator(ParseSpec(spec)); }

Simulator::Simulator(const Spec& spec)
    : Simulator(spec, MakeCamera(spec.distortion), MakePlace(spec)) {}

Simulator::Simulator(const Spec& spec, const Camera& camera, Place place)
    : spec_(spec),
      camera_(camera),
      exposure_s_(place.exposure_s),
      trajectory_(std::move(place.waypoint), place.knot_s, place.hand, Hash({spec.seed, 0x4a9d})),
      renderer_(std::move(place.scene), camera_),
      sensor_(camera_, MakeSensorOptions(spec)) {}

int64_t Simulator::stamp_us(int i) const {
  return kFirstStamp_us + static_cast<int64_t>(i) * 1'000'000 / static_cast<int64_t>(kFps);
}

SE3 Simulator::world_from_cam(int i) const {
  return trajectory_.WorldFromCam(1e-6 * static_cast<double>(stamp_us(i)));
}

cv::Mat1b Simulator::Render(int i) {
  Renderer::Exposure poses;
  for (int k = 0; k < Renderer::kSubFrames; ++k) {
    poses[k] = trajectory_.WorldFromCam(1e-6 * static_cast<double>(stamp_us(i)) +
                                        exposure_s_ * Renderer::SubFrameTime(k));
  }
  return sensor_.Expose(renderer_.Radiance(poses),
                        Hash({spec_.seed, 0x4015e, static_cast<uint64_t>(i)}));
}

cv::Mat1f Simulator::Depth(int i) { return renderer_.Depth(world_from_cam(i)); }

}  // namespace vpslam::simulator
