// The true pose of a frame, where the source knows it: for viewers and tests, used by nothing else.
#pragma once

#include <cstdint>

#include "core/geometry/se3.h"

namespace vpslam {

struct Truth {
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  SE3 world_from_cam;
};

}  // namespace vpslam
