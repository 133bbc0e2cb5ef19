// ORB features [Rublee11, "ORB: an efficient alternative to SIFT or SURF", ICCV 2011]: FAST corners
// on an image pyramid, spread evenly over the image, with an orientation by intensity centroid and
// a steered binary descriptor.
//
// The extractor sees the distorted image; what it returns is undistorted. Same image, same options:
// same features, to the bit.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>

#include "core/features/features.h"
#include "core/features/keypoint_distribution.h"
#include "core/features/scale_levels.h"
#include "core/geometry/camera.h"

namespace vpslam {

struct OrbOptions {
  int num_features = 1000;     ///< to be found per image, over all levels; an upper limit
  int num_levels = 8;          ///< of the pyramid; tiny images get fewer
  double scale_factor = 1.2;   ///< between levels
  double sigma_px = 0.9;       ///< accuracy of a corner on level 0, with that of the calibration
  int fast_threshold = 20;     ///< grey levels by which a corner's arc differs from its centre
  int fast_threshold_low = 5;  ///< the same, in cells where the first one found nothing
  int cell_px = 32;            ///< size of such a cell, in px of its level
  DistributionOptions distribution = {};

  template <class V>
  void Visit(V& v) {
    v("num_features", num_features);
    v("num_levels", num_levels);
    v("scale_factor", scale_factor);
    v("sigma_px", sigma_px);
    v("fast_threshold", fast_threshold);
    v("fast_threshold_low", fast_threshold_low);
    v("cell_px", cell_px);
    v("distribution", distribution);
  }
  std::optional<std::string> Validate() const;
};

/// Time spent per stage by one call of Extract, in ms.
struct OrbTimings {
  double pyramid_ms = 0;
  double detection_ms = 0;     ///< FAST
  double distribution_ms = 0;  ///< choice of the corners that are kept
  double orientation_ms = 0;
  double description_ms = 0;
  double position_ms = 0;  ///< to fractions of pixels, undistorted
};

/// Holds the buffers between images, so one per thread.
class OrbExtractor {
 public:
  /// Throws std::invalid_argument if `camera` or `options` are not valid.
  OrbExtractor(const Camera& camera, const OrbOptions& options);
  ~OrbExtractor();
  OrbExtractor(OrbExtractor&&) noexcept;
  OrbExtractor& operator=(OrbExtractor&&) noexcept;

  /// `image` is CV_8UC1, of the camera's size (std::invalid_argument otherwise). Ordered by octave;
  /// none where the camera's mask hides what is there.
  Features Extract(const cv::Mat& image);

  const ScalePyramid& scales() const;
  const OrbTimings& last_timings() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vpslam
