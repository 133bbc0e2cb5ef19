// Matches that agree on how the image turned.
//
// Between two views most key points turn by about the same angle, whereas that of a wrong match is
// anything. So: histogram of the differences, keep its highest bins ([Lowe04] sec. 7.3 uses the
// same idea as a Hough transform).
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vpslam {

struct RotationConsistencyOptions {
  int num_bins = 30;       ///< over the full circle
  int keep_bins = 3;       ///< highest bins that are kept
  double min_share = 0.1;  ///< of the highest bin's count, which another bin needs to be kept

  std::optional<std::string> Validate() const;
};

/// For each difference of two angles (any multiple of 2 pi may be in it): 1 if it lies in a bin
/// that is kept, else 0.
std::vector<uint8_t> FindRotationConsistent(std::span<const float> differences_rad,
                                            const RotationConsistencyOptions& options = {});

}  // namespace vpslam
