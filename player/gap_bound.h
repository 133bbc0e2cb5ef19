// Time as it is played: as it was taken, but for gaps that nobody wants to wait for. A clock that
// is set while a sequence is recorded jumps by years, and a recording that was interrupted by
// hours.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

namespace vpslam {

class GapBound {
 public:
  static constexpr int64_t kLongest_us = 5'000'000;

  /// The time of the image with this stamp, to be asked for once, in order of the stamps.
  int64_t TimeOf(int64_t stamp_us) {
    const int64_t gap_us = last_us_ ? stamp_us - *last_us_ : 0;
    last_us_ = stamp_us;
    newest_gap_us_ = gap_us > kLongest_us ? gap_us : 0;
    count_ += newest_gap_us_ > 0;
    shortened_us_ += std::max<int64_t>(0, gap_us - kLongest_us);
    return stamp_us - shortened_us_;
  }

  /// The gap before the image that was asked for last, if it was shortened; else 0.
  int64_t newest_gap_us() const { return newest_gap_us_; }
  int count() const { return count_; }

 private:
  std::optional<int64_t> last_us_;
  int64_t shortened_us_ = 0;
  int64_t newest_gap_us_ = 0;
  int count_ = 0;
};

}  // namespace vpslam
