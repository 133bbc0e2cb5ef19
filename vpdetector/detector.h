// One image in, one LineSet out. The answer depends on the image, the camera and the options alone,
// never on images seen before, so that any number of detectors can share the load.
#pragma once

#include <optional>
#include <string>

#include <opencv2/core.hpp>

#include "core/features/line_set.h"
#include "core/geometry/camera.h"
#include "vpdetector/line_descriptor.h"
#include "vpdetector/line_extractor.h"
#include "vpdetector/vp_estimator.h"

namespace vpslam {

struct DetectorOptions {
  LineExtractorOptions lines;
  LineDescriptorOptions descriptors;
  VpOptions vps;

  template <class V>
  void Visit(V& v) {
    v("lines", lines);
    v("descriptors", descriptors);
    v("vps", vps);
  }
  std::optional<std::string> Validate() const;
};

class Detector {
 public:
  /// Throws std::invalid_argument if camera or options do not validate.
  Detector(const Camera& camera, const DetectorOptions& options);

  /// `gray` is CV_8UC1 as the lens sees it. Throws std::invalid_argument if its type or size is not
  /// the camera's. frame_seq and stamp_us of the result are left at 0.
  LineSet Detect(const cv::Mat& gray) const;

  const Camera& camera() const { return camera_; }
  const DetectorOptions& options() const { return options_; }

 private:
  Camera camera_;
  DetectorOptions options_;
};

}  // namespace vpslam
