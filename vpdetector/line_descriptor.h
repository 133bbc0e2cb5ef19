// Line Band Descriptor, 256 bits. [Zhang13] L. Zhang, R. Koch, "An efficient and robust line
// segment matching approach based on LBD descriptor and pairwise geometric consistency", JVCIR
// 24(7), 2013.
//
// Nine bands of seven rows lie parallel to the segment. The gradients of a row are projected onto
// the segment's normal and direction, and each part's positive and negative values are added up.
// Mean and standard deviation, over the rows of a band and its neighbours, of those four sums
// describe the band: eight numbers. The bits compare those of two bands, for 32 pairs of bands.
//
// Other than in the paper, a row is sampled at no more than `max_samples` points, so that the cost
// of a line does not grow with its length, and the eight numbers are compared as they are: scaling
// all bands alike, as the paper does, changes no comparison.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "core/features/features.h"
#include "core/geometry/camera.h"
#include "vpdetector/edge_fit.h"

namespace vpslam {

struct LineDescriptorOptions {
  /// Shorter lines get no descriptor, since mapping does not use them.
  double min_length_px = 40.0;
  /// Only as many lines get one, the longest.
  int max_lines = 150;
  int max_samples = 32;

  template <class V>
  void Visit(V& v) {
    v("min_length_px", min_length_px);
    v("max_lines", max_lines);
    v("max_samples", max_samples);
  }
  std::optional<std::string> Validate() const;
};

/// Descriptors of the first `segments` in the CV_8UC1 image `gray`, as many as the options allow;
/// `segments` come longest first. They are followed through the image as the lens shows it; what
/// lies outside of it counts as its nearest pixel.
std::vector<Descriptor> DescribeLines(const cv::Mat& gray, const Camera& camera,
                                      const std::vector<EdgeSegment>& segments,
                                      const LineDescriptorOptions& options);

}  // namespace vpslam
