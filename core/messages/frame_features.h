// The point features of one image, for whoever wants to see or log them.
#pragma once

#include <cstdint>

#include "core/features/features.h"

namespace vpslam {

struct FrameFeatures {
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  Features features;
};

}  // namespace vpslam
