// The calibrations that come with the ASL layout of the EuRoC data sets: `sensor.yaml` of a camera,
// or Kalibr's camchain.yaml, as TUM-VI has it.
#pragma once

#include <string>

#include "core/geometry/camera.h"
#include "core/geometry/se3.h"

namespace vpslam {

struct EurocSensor {
  Camera camera;
  SE3 body_from_cam;  ///< T_BS, m
};

/// Throws std::runtime_error with one line naming file, fault and remedy. Without `with_camera` the
/// pose alone is read: where --camera names another calibration, the lens does not matter.
EurocSensor ReadEurocSensor(const std::string& path, bool with_camera = true);

/// cam0 of Kalibr's camchain.yaml; body_from_cam is the inverse of its T_cam_imu.
EurocSensor ReadKalibrCamera(const std::string& path, bool with_camera = true);

/// T_BS alone, of any sensor.
SE3 ReadEurocBodyFromSensor(const std::string& path);

}  // namespace vpslam
