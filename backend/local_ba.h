// Local bundle adjustment: the new keyframe, those that share most points with it, and the points
// they see are moved so that reprojection errors become least; other keyframes that see these
// points hold the gauge. [Mur15] sec. VI-D.
#pragma once

#include <functional>
#include <vector>

#include "backend/manhattan_frames.h"
#include "backend/mapper_options.h"
#include "backend/mapping_context.h"

namespace vpslam {

struct BaSummary {
  /// False where Ceres failed: nothing was changed.
  bool usable = false;
  int keyframes = 0;  ///< moved
  int fixed_keyframes = 0;
  int points = 0;
  int observations = 0;  ///< of points
  int outliers = 0;      ///< observations taken out of the map afterwards
  int iterations = 0;
  double initial_cost = 0;
  double final_cost = 0;
};

/// Whether others wait for the result, so that a better one is worth less than an early one. Asked
/// from time to time.
using IsUrgent = std::function<bool()>;

/// Adjusts around `keyframe`; removes observations that fail the chi-square gate afterwards,
/// adjusts once more without them if the options say so, and updates the views of the points moved.
/// Keyframes are held to the axes of `manhattan`. Ends after few iterations when `is_urgent`. The
/// costs in the summary are those of the first adjustment.
BaSummary AdjustLocally(const MappingContext& context, KeyframeId keyframe,
                        const ManhattanFrames& manhattan, const LocalBaOptions& options,
                        int max_iterations, const IsUrgent& is_urgent = {});

}  // namespace vpslam
