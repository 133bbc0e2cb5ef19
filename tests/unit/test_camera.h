// The camera of tests that need any: focal lengths differ, so that mixing them up shows.
#pragma once

#include "core/geometry/camera.h"

namespace vpslam {

inline Camera TestCamera() {
  Camera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = 500;
  camera.fy = 480;
  camera.cx = 320;
  camera.cy = 240;
  return camera;
}

}  // namespace vpslam
