// The pose of a camera from matches between points of the map and one image, some of them wrong:
// for relocalisation.
#pragma once

#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/camera.h"
#include "core/geometry/ransac.h"
#include "core/geometry/se3.h"

namespace vpslam {

struct PnpMatch {
  Eigen::Vector3d point_in_world;
  Eigen::Vector2d position_px;  ///< undistorted
  double sigma_px = 1;
};

struct PnpOptions {
  int min_inliers = 15;
  /// A third of the matches right is enough: 3 + 1 of them, and a sample costs microseconds.
  RansacOptions ransac{.max_iterations = 1000};

  template <class V>
  void Visit(V& v) {
    v("min_inliers", min_inliers);
    v("ransac", ransac);
  }

  std::optional<std::string> Validate() const;
};

struct PnpResult {
  SE3 cam_from_world;
  /// Per match: in front of the camera, squared error over variance < 5.991.
  std::vector<bool> inlier;
  int num_inliers = 0;
};

/// Three matches at a time give up to four poses, of which a fourth match chooses; the poses are
/// ranked by their truncated squared errors over all matches, and each new best one is refined
/// (RefinePose). nullopt if fewer than min_inliers matches agree. Matches that are not finite are
/// outliers. The same input and state of the generator give the same result.
std::optional<PnpResult> EstimatePnp(const Camera& camera, std::span<const PnpMatch> matches,
                                     const PnpOptions& options, std::mt19937_64& rng);

/// Minimises the reprojection error of the matches over the pose: Levenberg-Marquardt, Huber's loss
/// at sqrt(5.991) sigma. Points behind the camera do not take part. False, with the pose as it was,
/// if fewer than three points are in front of it.
bool RefinePose(const Camera& camera, std::span<const PnpMatch> matches, int max_iterations,
                SE3* cam_from_world);

}  // namespace vpslam
