// `sensor.yaml` of a camera in the ASL layout of the EuRoC data sets.
#pragma once

#include <string>

#include "core/geometry/camera.h"
#include "core/geometry/se3.h"

namespace vpslam {

struct EurocSensor {
  Camera camera;
  SE3 body_from_cam;  ///< T_BS, m
};

/// Throws std::runtime_error with one line naming file, fault and remedy.
EurocSensor ReadEurocSensor(const std::string& path);

}  // namespace vpslam
