#include "core/geometry/resting_matches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace vpslam {
namespace {

/// Weights with a sum of 1 for each part of the image that shows anything: every part counts alike,
/// however many corners it has.
std::vector<double> ShareOfImage(std::span<const TwoViewMatch> matches) {
  constexpr double kParts = 8;  // along the longer side
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::max());
  Eigen::Vector2d high = -low;
  for (const TwoViewMatch& m : matches) {
    low = low.cwiseMin(m.first_px);
    high = high.cwiseMax(m.first_px);
  }
  const double part_px = std::max((high - low).maxCoeff() / kParts, 1.0);
  std::map<std::pair<int, int>, int> counts;
  const auto part_of = [&](const TwoViewMatch& m) {
    const Eigen::Vector2d at = (m.first_px - low) / part_px;
    return std::pair(static_cast<int>(at.x()), static_cast<int>(at.y()));
  };
  for (const TwoViewMatch& m : matches) ++counts[part_of(m)];
  std::vector<double> weights;
  for (const TwoViewMatch& m : matches) weights.push_back(1.0 / counts[part_of(m)]);
  return weights;
}

}  // namespace

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
  if (matches.empty()) return stays;
  const std::vector<double> weights = ShareOfImage(matches);
  double all = 0, resting = 0, moving = 0;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const TwoViewMatch& m = matches[i];
    const double sigmas =
        (m.second_px - m.first_px).norm() / std::hypot(m.first_sigma_px, m.second_sigma_px);
    stays[i] = sigmas <= options.min_moving_sigmas;
    all += weights[i];
    if (sigmas < options.max_resting_sigmas) resting += weights[i];
    if (!stays[i]) moving += weights[i];
  }
  const double between = all - resting - moving;
  const bool is_something = resting >= options.min_resting_share * all &&
                            moving >= options.min_moving_share * all &&
                            between <= options.max_between * resting;
  if (!is_something) stays.assign(matches.size(), false);
  return stays;
}

}  // namespace vpslam
