#include "core/features/frame_observation.h"

#include <utility>

namespace vpslam {

std::shared_ptr<const FrameObservation> FrameObservation::Make(
    int64_t frame_seq, int64_t stamp_us, Features features, const Camera::Bounds& bounds,
    std::shared_ptr<const LineSet> lines) {
  FeatureGrid grid(features.keypoints, bounds);
  return std::make_shared<const FrameObservation>(FrameObservation{
      frame_seq, stamp_us, std::move(features), std::move(grid), std::move(lines)});
}

const std::vector<LineSegment>& FrameObservation::segments() const {
  static const std::vector<LineSegment> kNone;
  return lines ? lines->lines : kNone;
}

}  // namespace vpslam
