// Who needs the lines of an image asks one detector for them.
#pragma once

#include <cstdint>

namespace vpslam {

struct LinesRequest {
  int64_t frame_seq = 0;      ///< of the image
  int64_t image_session = 0;  ///< session of the image's sender
  int64_t detector = 0;       ///< session of the vpdetector that is to answer, with LINES
};

}  // namespace vpslam
