// One image on its way from the player to detectors and frontend.
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

#include "core/messages/stages.h"

namespace vpslam {

struct ImageFrame {
  int64_t frame_seq = 0;  ///< index in the source, from 0; frames that the source skips have none
  int64_t stamp_us = 0;   ///< time of capture; any epoch, 0 is valid
  int64_t published_us = 0;  ///< CLOCK_MONOTONIC of this host when it was sent
  double decode_ms = kNotRun;
  cv::Mat pixels;  ///< CV_8UC1, as the lens sees it (distorted)
};

}  // namespace vpslam
