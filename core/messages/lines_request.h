// Who needs the lines of an image asks one detector for them.
#pragma once

#include <cstdint>

#include "core/base/description.h"

namespace vpslam {

struct LinesRequest {
  int64_t frame_seq = 0;      ///< of the image
  int64_t image_session = 0;  ///< session of the image's sender
  int64_t detector = 0;       ///< session of the vpdetector that is to answer, with LINES

  static constexpr const char* kWireName = "lines_request_t";
  static void Describe(auto& v, auto& m) {
    auto& [frame_seq, image_session, detector] = m;
    v("frame_seq", frame_seq, kNotNegative);
    v("image_session", image_session);
    v("detector", detector);
  }
};

}  // namespace vpslam
