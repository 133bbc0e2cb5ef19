// How much of an edge a corner is: one that lies on a straight edge is well known across it only.
#pragma once

#include <opencv2/core/mat.hpp>

namespace vpslam {

struct EdgeShape {
  /// The smaller over the larger eigenvalue of the structure tensor [Foerstner87, "A fast operator
  /// for detection and precise location of distinct points, corners and centres of circular
  /// features"]: 1 if the position is known alike in all directions, 0 on a straight edge.
  float roundness;
  float edge_rad;  ///< direction of the edge, in [0, pi), from the x axis towards the y axis
};

/// Of the 7 x 7 px around (x, y) of a CV_8UC1 image, in which 4 px around must lie. Where there is
/// no gradient, roundness is 1.
EdgeShape EdgeShapeAt(const cv::Mat& image, int x, int y);

}  // namespace vpslam
