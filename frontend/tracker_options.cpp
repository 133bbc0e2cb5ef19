#include "frontend/tracker_options.h"

namespace vpslam {

std::optional<std::string> TrackerOptions::Validate() const {
  if (const auto why = orb.Validate()) return why;
  if (const auto why = initializer.two_view.Validate()) return why;
  if (const auto why = initializer.resting.Validate()) return why;
  if (num_features_to_start < orb.num_features) {
    return "num_features_to_start must not be less than orb.num_features";
  }
  if (probation_keyframes < 2) return "probation_keyframes must be at least 2";
  return std::nullopt;
}

}  // namespace vpslam
