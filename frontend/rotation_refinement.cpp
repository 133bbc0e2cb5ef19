#include "frontend/rotation_refinement.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/LU>

#include "core/estimation/absolute_rotation.h"
#include "core/estimation/linear_translation.h"
#include "core/features/manhattan_quality.h"
#include "core/geometry/axis_naming.h"
#include "core/geometry/so3.h"

namespace vpslam {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

}  // namespace

bool PaperRotation::Refine(const LineSet& lines, Eigen::Quaterniond* cam_from_world) {
  const auto seen = DominantDirections(lines, camera_, options_.min_cluster_lines);
  if (!directions_in_world_) {
    std::array<Eigen::Vector3d, 3> in_world;
    int count = 0, missing = 0;
    for (int k = 0; k < 3; ++k) {
      if (seen[k]) {
        in_world[k] = cam_from_world->conjugate() * *seen[k];
        ++count;
      } else {
        missing = k;
      }
    }
    if (count < 2) return false;
    if (count == 2) {
      in_world[missing] =
          in_world[(missing + 1) % 3].cross(in_world[(missing + 2) % 3]).normalized();
    }
    directions_in_world_ = in_world;
    return false;
  }
  // Which of the frozen directions a cluster shows: the one next to where the pose expects it.
  const double min_cosine = std::cos(options_.max_innovation_deg * kRadPerDeg);
  std::vector<DirectionPair> pairs;
  for (const auto& direction : seen) {
    if (!direction) continue;
    for (const Eigen::Vector3d& in_world : *directions_in_world_) {
      const double cosine = direction->dot(*cam_from_world * in_world);
      if (std::abs(cosine) < min_cosine) continue;
      pairs.push_back({cosine < 0 ? Eigen::Vector3d(-*direction) : *direction, in_world});
      break;
    }
  }
  if (pairs.size() < 2) return false;
  *cam_from_world = OptimizeAbsoluteRotation(pairs, *cam_from_world);
  return true;
}

std::optional<RotationMeasurement> MeasureRotation(const LineSet& lines,
                                                   const Eigen::Quaterniond& world_from_manhattan,
                                                   const Eigen::Quaterniond& cam_from_world,
                                                   const VpRotationOptions& options) {
  if (!IsSoundManhattan(lines, options.min_support, options.max_sigma_deg * kRadPerDeg)) {
    return std::nullopt;
  }
  const Eigen::Quaterniond predicted = cam_from_world * world_from_manhattan;
  const Eigen::Quaterniond named = NamedNearest(lines.cam_from_manhattan, predicted);
  if (AngleBetween_rad(named, predicted) > options.max_innovation_deg * kRadPerDeg) {
    return std::nullopt;
  }
  const double extra_rad = options.extra_sigma_deg * kRadPerDeg;
  const Eigen::Matrix3d covariance =
      lines.covariance_rad2 + extra_rad * extra_rad * Eigen::Matrix3d::Identity();
  return RotationMeasurement{(named * world_from_manhattan.conjugate()).normalized(),
                             covariance.inverse()};
}

void RefineTranslation(const TrackingContext& context, TranslationMode mode, int min_inliers,
                       std::mt19937_64& rng, Frame* frame) {
  if (mode == TranslationMode::kOff) return;
  const auto weights = mode == TranslationMode::kPaper ? TranslationWeights::kNone
                                                       : TranslationWeights::kInverseDepth;
  std::vector<int> features, segments;
  const PoseMeasurements measured = Measure(context, frame, &features, &segments);
  const auto translation =
      EstimateTranslation(context.camera, measured.points, frame->placement.cam_from_world.rotation,
                          weights, min_inliers, rng);
  if (translation) frame->placement.cam_from_world.translation = *translation;
}

}  // namespace vpslam
