// Finds two views from which a map can start.
//
// Keeps a reference view and follows its features from frame to frame; each new frame is tried
// against it. The reference is given up for the present frame when too few of its features are left
// or when it has been tried for long.
#pragma once

#include <optional>
#include <random>
#include <vector>

#include "core/features/scale_levels.h"
#include "core/geometry/camera.h"
#include "core/messages/keyframe_proposal.h"
#include "frontend/frame.h"
#include "frontend/tracker_options.h"

namespace vpslam {

/// Two views and what they show. The second is the frame that was added; the world is the first
/// camera, and the median depth of the points 1.
struct InitialMap {
  Frame first;
  SE3 second_from_first;
  std::vector<InitialPoint> points;
};

class Initializer {
 public:
  /// `camera` and `scales` must outlive it.
  Initializer(const Camera& camera, const ScalePyramid& scales, const InitializerOptions& options)
      : camera_(&camera), scales_(&scales), options_(options) {}

  /// Tries the frame as second view; without success it may become the reference.
  std::optional<InitialMap> Add(const Frame& frame, std::mt19937_64& rng);

 private:
  void TakeAsReference(const Frame& frame);
  /// The motion to start from; nullptr if there is none, or it is not clear which.
  /// `lines`: of the second view; may be nullptr.
  const TwoViewCandidate* Decide(const TwoViewResult& result, const LineSet* lines) const;

  const Camera* camera_;
  const ScalePyramid* scales_;
  InitializerOptions options_;
  std::optional<Frame> reference_;
  std::vector<Eigen::Vector2f> predicted_px_;  ///< per feature of the reference: where last seen
  int frames_tried_ = 0;
};

}  // namespace vpslam
