// Settings of the backend; read from the `backend` section of a system configuration file.
#pragma once

#include <optional>
#include <string>

namespace vpslam {

struct MapperOptions {
  int max_local_keyframes = 20;  ///< whose poses local bundle adjustment moves

  std::optional<std::string> Validate() const;
};

}  // namespace vpslam
