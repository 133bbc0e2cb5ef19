#include "player/bad_frame_guard.h"

#include <algorithm>

#include <fmt/format.h>

namespace vpslam {

std::optional<std::string> BadFrameGuard::CountBad() {
  ++bad_;
  ++in_a_row_;
  if (good_ == 0 && bad_ == total_) return "no image is left";
  if (good_ == 0 && in_a_row_ > options_.max_at_start) {
    return fmt::format("the first {} images are bad", in_a_row_);
  }
  if (in_a_row_ > options_.max_in_a_row) {
    return fmt::format("{} images in a row are bad", in_a_row_);
  }
  if (IsTooMany(bad_)) return fmt::format("{} of {} images are bad", bad_, total_);
  return std::nullopt;
}

bool BadFrameGuard::IsTooMany(int64_t bad) const {
  const double fraction = options_.max_fraction * static_cast<double>(total_);
  return total_ > 0 && bad > std::max(options_.always_allowed, static_cast<int64_t>(fraction));
}

}  // namespace vpslam
