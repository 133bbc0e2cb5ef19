// Settings of the frontend; read from the `frontend` section of a system configuration file.
#pragma once

#include <optional>
#include <string>

namespace vpslam {

struct TrackerOptions {
  int num_features = 1000;         ///< ORB features per frame
  int num_features_to_start = 2000;  ///< while there is no map

  std::optional<std::string> Validate() const;
};

}  // namespace vpslam
