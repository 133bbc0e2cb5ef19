// What vanishing points say about a frame's rotation, and the translation that follows from it: the
// paper's sections III-B and III-C as modes, and what is done instead (docs/method.md).
#pragma once

#include <array>
#include <optional>
#include <random>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "core/estimation/pose_optimizer.h"
#include "core/geometry/camera.h"
#include "frontend/frame.h"
#include "frontend/frame_tracking.h"
#include "frontend/tracker_options.h"

namespace vpslam {

/// The paper's mode: directions of the world, frozen at the first frame that shows two of them.
class PaperRotation {
 public:
  PaperRotation(const Camera& camera, const VpRotationOptions& options)
      : camera_(camera), options_(options) {}

  /// Overwrites the rotation of `cam_from_world`; false, and nothing done, where the frame does not
  /// show two of the frozen directions, or is the one that they are taken from.
  bool Refine(const LineSet& lines, Eigen::Quaterniond* cam_from_world);
  void Reset() { directions_in_world_.reset(); }

 private:
  const Camera& camera_;
  VpRotationOptions options_;
  std::optional<std::array<Eigen::Vector3d, 3>> directions_in_world_;
};

/// The fused mode: the detector's Manhattan rotation against the frame of the map, named so that it
/// lies nearest to `cam_from_world`. nullopt if it is not worth much or lies too far from that.
std::optional<RotationMeasurement> MeasureRotation(const LineSet& lines,
                                                   const Eigen::Quaterniond& world_from_manhattan,
                                                   const Eigen::Quaterniond& cam_from_world,
                                                   const VpRotationOptions& options);

/// Overwrites the translation with that of sec. III-C, where enough of the frame's points agree.
void RefineTranslation(const TrackingContext& context, TranslationMode mode, int min_inliers,
                       std::mt19937_64& rng, Frame* frame);

}  // namespace vpslam
