// Features come from other processes and from logs, whose image pyramid may have more levels.
#pragma once

#include <stdexcept>
#include <string>

#include "core/features/features.h"
#include "core/features/scale_levels.h"

namespace vpslam {

/// Throws std::runtime_error, which names `setting` as the remedy, if a key point lies on a level
/// that the pyramid does not have.
inline void CheckOctaves(const Features& features, const ScalePyramid& scales,
                         const std::string& setting) {
  for (const Keypoint& keypoint : features.keypoints) {
    if (keypoint.octave < scales.num_levels()) continue;
    throw std::runtime_error("a feature comes from pyramid level " +
                             std::to_string(keypoint.octave) + ", but " + setting + " is " +
                             std::to_string(scales.num_levels()) +
                             "; set it as it was where the features were found");
  }
}

}  // namespace vpslam
