#include "core/transport/image_message.h"

namespace vpslam {

std::optional<std::string> ImageMessage::Validate() const {
  if (segment.empty()) {
    if (bytes.size() == static_cast<std::size_t>(width) * height) return std::nullopt;
    return "number of bytes does not fit width x height";
  }
  if (!IsImageSegmentName(segment)) return "alien name of a shared memory segment";
  if (!bytes.empty()) return "pixels both inline and in shared memory";
  if (slot < 0 || slot > 65535) return "slot: out of range";
  if (generation <= 0 || generation % 2 != 0) return "generation: out of range";
  return std::nullopt;
}

}  // namespace vpslam
