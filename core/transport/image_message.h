// An image as it travels: its pixels inline, or where in shared memory they lie.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/messages/image_frame.h"

namespace vpslam {

struct ImageMessage {
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  int64_t published_us = 0;
  double decode_ms = kNotRun;
  int32_t width = 0;    ///< px
  int32_t height = 0;   ///< px; rows follow each other without padding, one byte per pixel
  std::string segment;  ///< name of the POSIX shared memory; empty: inline
  int32_t slot = 0;
  int64_t generation = 0;      ///< of the slot when it was written
  std::vector<uint8_t> bytes;  ///< inline: width x height
};

/// With the pixels inside: for other hosts and for logs.
ImageMessage InlineImage(const ImageFrame& frame);

}  // namespace vpslam
