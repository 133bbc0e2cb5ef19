// What one image showed: made once, then shared by everything that works with the image.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/features/feature_grid.h"
#include "core/features/features.h"
#include "core/features/line_set.h"
#include "core/geometry/camera.h"

namespace vpslam {

/// Immutable once made: held as std::shared_ptr<const FrameObservation>, so that whoever keeps an
/// image's features (a frame to be placed later, a keyframe) copies a pointer. Says nothing of
/// where the camera stood: that is what a placement in a map believes (frontend/placement.h).
struct FrameObservation {
  int64_t frame_seq = 0;
  int64_t stamp_us = 0;
  Features features;
  FeatureGrid grid;                      ///< of features.keypoints
  std::shared_ptr<const LineSet> lines;  ///< nullptr without a detector

  /// `bounds`: of the undistorted image.
  static std::shared_ptr<const FrameObservation> Make(
      int64_t frame_seq, int64_t stamp_us, Features features, const Camera::Bounds& bounds,
      std::shared_ptr<const LineSet> lines = nullptr);

  int num_features() const { return features.size(); }
  int num_segments() const { return static_cast<int>(segments().size()); }
  /// Empty without a detector.
  const std::vector<LineSegment>& segments() const;
};

}  // namespace vpslam
