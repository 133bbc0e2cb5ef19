#include "core/features/rotation_consistency.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace vpslam {

std::optional<std::string> RotationConsistencyOptions::Validate() const {
  if (num_bins < 1 || num_bins > 3600) return "num_bins must lie in 1 to 3600";
  if (keep_bins < 1) return "keep_bins must be at least 1";
  if (!(min_share >= 0 && min_share <= 1)) return "min_share must lie in 0 to 1";
  return std::nullopt;
}

std::vector<uint8_t> FindRotationConsistent(std::span<const float> differences_rad,
                                            const RotationConsistencyOptions& options) {
  constexpr double kTwoPi = 2 * std::numbers::pi;
  std::vector<int> bin_of(differences_rad.size());
  std::vector<int> count(options.num_bins, 0);
  for (size_t i = 0; i < differences_rad.size(); ++i) {
    const double turns = differences_rad[i] / kTwoPi;
    // Bins are centred on multiples of their width, lest an unturned image be split in two.
    const int bin = static_cast<int>(std::lround((turns - std::floor(turns)) * options.num_bins)) %
                    options.num_bins;
    bin_of[i] = bin;
    ++count[bin];
  }
  std::vector<int> order(options.num_bins);
  for (int i = 0; i < options.num_bins; ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return count[a] > count[b]; });

  std::vector<uint8_t> kept_bin(options.num_bins, 0);
  for (int i = 0; i < std::min(options.keep_bins, options.num_bins); ++i) {
    kept_bin[order[i]] = count[order[i]] >= options.min_share * count[order[0]];
  }
  std::vector<uint8_t> kept(differences_rad.size());
  for (size_t i = 0; i < kept.size(); ++i) kept[i] = kept_bin[bin_of[i]];
  return kept;
}

}  // namespace vpslam
