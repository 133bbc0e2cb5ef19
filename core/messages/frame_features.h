// All that the tracker takes from one image: point features, and lines where there are detectors.
//
// Live tracking and the replay of a log consume this one struct, which holds numbers exactly as
// messages do; so both compute the same, to the bit.
#pragma once

#include <cstdint>
#include <memory>

#include "core/features/features.h"
#include "core/features/line_set.h"
#include "core/messages/stages.h"

namespace vpslam {

struct FrameFeatures {
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  int64_t published_us = 0;  ///< as ImageFrame::published_us
  double decode_ms = kNotRun;
  double features_ms = kNotRun;  ///< spent on finding them
  Features features;
  std::shared_ptr<const LineSet> lines;  ///< nullptr: tracked without lines
};

}  // namespace vpslam
