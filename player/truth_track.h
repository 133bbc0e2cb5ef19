// True poses by time, as data sets give them beside the images.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "core/geometry/se3.h"

namespace vpslam {

class TruthTrack {
 public:
  /// A later pose of the same time replaces the earlier one.
  void Add(int64_t stamp_us, const SE3& world_from_cam) { poses_[stamp_us] = world_from_cam; }

  /// The pose nearest in time, at most `tolerance_us` away: the benchmark tools' usual 0.02 s.
  std::optional<SE3> Nearest(int64_t stamp_us, int64_t tolerance_us = 20'000) const;

  size_t size() const { return poses_.size(); }
  /// Of a track that is not empty.
  int64_t first_us() const { return poses_.begin()->first; }
  int64_t last_us() const { return poses_.rbegin()->first; }

 private:
  std::map<int64_t, SE3> poses_;
};

}  // namespace vpslam
