// From an image to undistorted segments: detector, sub-pixel fit, merging, selection.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "core/geometry/camera.h"
#include "vpdetector/edge_fit.h"
#include "vpdetector/line_detector.h"

namespace vpslam {

struct LineExtractorOptions {
  LineDetectorOptions detector;
  EdgeFitOptions fit;
  /// Segments that are shorter after merging are dropped.
  double min_length_px = 20.0;
  /// Fragments that stay this close to one side of the image are the frame of it (a black border,
  /// the end of a blur), not of the world.
  double border_px = 4.0;
  /// Segments that reach further out than this many widths and heights of the image are dropped:
  /// only a distortion model that is stretched beyond its range puts them there.
  double max_extent = 10.0;
  /// Only as many segments are kept, the longest: a bound for time and message size.
  int max_lines = 500;

  template <class V>
  void Visit(V& v) {
    v("detector", detector);
    v("fit", fit);
    v("min_length_px", min_length_px);
    v("border_px", border_px);
    v("max_extent", max_extent);
    v("max_lines", max_lines);
  }
  std::optional<std::string> Validate() const;
};

/// Longest first. `gray` is CV_8UC1, of the camera's size; there are none where its mask hides what
/// is there.
std::vector<EdgeSegment> ExtractLines(const cv::Mat& gray, const Camera& camera,
                                      const LineExtractorOptions& options);

}  // namespace vpslam
