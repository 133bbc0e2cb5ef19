// A simulated camera in a simulated place: images with exact truth. docs/simulator.md shows it and
// says how it compares with photographs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "core/geometry/camera.h"
#include "core/geometry/se3.h"
#include "player/simulator/place.h"
#include "player/simulator/renderer.h"
#include "player/simulator/sensor.h"
#include "player/simulator/spec.h"
#include "player/simulator/trajectory.h"

namespace vpslam::simulator {

/// Frame i depends on the spec and i alone: not on the number of frames, nor on what was rendered
/// before.
class Simulator {
 public:
  /// Builds the scene, which takes some two seconds. See ParseSpec for `spec` and what it throws.
  static Simulator Create(const std::string& spec);
  explicit Simulator(const Spec& spec);

  int frames() const { return spec_.frames; }
  const Camera& camera() const { return camera_; }
  /// Middle of the exposure; the first frame is at 1 s.
  int64_t stamp_us(int i) const;
  /// Pose at stamp_us(i).
  SE3 world_from_cam(int i) const;
  /// The image, grey.
  cv::Mat1b Render(int i);
  /// Depth z at pixel centres at stamp_us(i), m; 0 where nothing is seen.
  cv::Mat1f Depth(int i);
  /// Straight edges and marks of the scene, whether or not the camera ever sees them.
  const std::vector<Line3d>& lines3d() const { return renderer_.scene().lines; }
  /// Unit Manhattan directions in the world, as columns.
  Eigen::Matrix3d manhattan() const { return Eigen::Matrix3d::Identity(); }
  const Scene& scene() const { return renderer_.scene(); }

 private:
  Simulator(const Spec& spec, const Camera& camera, Place place);

  Spec spec_;
  Camera camera_;
  double exposure_s_;
  Trajectory trajectory_;
  Renderer renderer_;
  Sensor sensor_;
};

}  // namespace vpslam::simulator
