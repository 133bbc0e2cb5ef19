// The true pose of a frame, where the source knows it: for viewers and tests, used by nothing else.
#pragma once

#include <cstdint>

#include "core/base/description.h"
#include "core/geometry/se3.h"

namespace vpslam {

struct Truth {
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  SE3 world_from_cam;

  static constexpr const char* kWireName = "truth_t";
  static void Describe(auto& v, auto& m) {
    auto& [frame_seq, stamp_us, world_from_cam] = m;
    v("frame_seq", frame_seq, kNotNegative);
    v("stamp_us", stamp_us);
    v("world_from_cam", world_from_cam);
  }
};

}  // namespace vpslam
