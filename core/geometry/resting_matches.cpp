#include "core/geometry/resting_matches.h"

#include <cmath>

namespace vpslam {

std::optional<std::string> RestingMatchesOptions::Validate() const {
  if (!(max_resting_sigmas > 0)) return "max_resting_sigmas must be positive";
  if (!(min_moving_sigmas >= max_resting_sigmas)) {
    return "min_moving_sigmas must not be below max_resting_sigmas";
  }
  if (!(min_resting_share >= 0 && min_resting_share <= 1)) {
    return "min_resting_share must lie in 0 to 1";
  }
  if (!(min_moving_share > 0 && min_moving_share <= 1)) {
    return "min_moving_share must lie in 0 to 1";
  }
  if (!(max_between >= 0)) return "max_between must not be negative";
  return std::nullopt;
}

std::vector<bool> RestingMatches(std::span<const TwoViewMatch> matches,
                                 const RestingMatchesOptions& options) {
  std::vector<bool> stays(matches.size());
  double num_resting = 0, num_moving = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const TwoViewMatch& m = matches[i];
    const double sigmas =
        (m.second_px - m.first_px).norm() / std::hypot(m.first_sigma_px, m.second_sigma_px);
    stays[i] = sigmas <= options.min_moving_sigmas;
    num_resting += sigmas < options.max_resting_sigmas;
    num_moving += !stays[i];
  }
  const double count = static_cast<double>(matches.size());
  const double num_between = count - num_resting - num_moving;
  const bool is_something = num_resting >= options.min_resting_share * count &&
                            num_moving >= options.min_moving_share * count &&
                            num_between <= options.max_between * num_resting;
  if (!is_something) stays.assign(matches.size(), false);
  return stays;
}

}  // namespace vpslam
