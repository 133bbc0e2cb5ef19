// The true poses of the frames that were played, as a file in TUM's format, so that every source's
// truth can be compared with the results in the same way.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>

#include "core/geometry/se3.h"

namespace vpslam {

class TruthFile {
 public:
  /// Nothing is written before the first pose comes: a source without truth leaves no file. A file
  /// of that name is removed.
  explicit TruthFile(std::string path);

  /// Throws std::runtime_error with one line naming file and remedy if the file cannot be made. A
  /// disk that is full later is told in the log, once: the run is worth more.
  void Add(int64_t stamp_us, const SE3& world_from_cam);

 private:
  std::string path_;
  std::ofstream file_;
  bool is_given_up_ = false;  ///< the disk is full
};

}  // namespace vpslam
