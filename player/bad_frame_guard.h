// Decides whether bad frames are an accident, to be skipped, or the state of the source.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace vpslam {

struct BadFrameOptions {
  int max_at_start = 2;        ///< in a row, before the first good frame
  int max_in_a_row = 5;        ///< later: a sixth of a second at 30 Hz
  double max_fraction = 0.05;  ///< of all frames...
  int64_t always_allowed = 1;  ///< ...but so many in any case
};

class BadFrameGuard {
 public:
  /// `total` is the number of frames of the source; 0 where that is unknown (a live camera), and
  /// then the fraction is not judged. So many of them are `bad_already` and will not come.
  explicit BadFrameGuard(int64_t total, const BadFrameOptions& options = {},
                         int64_t bad_already = 0)
      : total_(total), options_(options), bad_(bad_already) {}

  void CountGood() {
    ++good_;
    in_a_row_ = 0;
  }

  /// Why the source has to be given up with this bad frame; nullopt if it is to be skipped.
  std::optional<std::string> CountBad();

  /// Whether so many bad frames are too many of all.
  bool IsTooMany(int64_t bad) const;

  int64_t good() const { return good_; }
  int64_t bad() const { return bad_; }

 private:
  int64_t total_;
  BadFrameOptions options_;
  int64_t good_ = 0, bad_ = 0;
  int in_a_row_ = 0;
};

}  // namespace vpslam
