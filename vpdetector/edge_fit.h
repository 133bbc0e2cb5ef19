// Straight segments through sub-pixel edge points.
//
// A detector's fragment only says where to look. Across it, at every pixel of its length, the
// position of the edge is the centre of gravity of the gradient of the fragment's own polarity; the
// points are undistorted one by one, so that an edge that the lens bends is fitted where it is
// straight; and a line is laid through them by total least squares, each weighed by its gradient
// (the variance of an edge's position goes with one over the gradient squared). Collinear fragments
// of one edge merge by adding up the moments of their points.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "core/geometry/camera.h"
#include "vpdetector/line_detector.h"

namespace vpslam {

/// Weighted sums over points, about the origin of pixels.
struct EdgeMoments {
  double points = 0;  ///< how many
  double weight = 0;
  Eigen::Vector2d first = Eigen::Vector2d::Zero();
  Eigen::Matrix2d second = Eigen::Matrix2d::Zero();

  void Add(const Eigen::Vector2d& x, double w) {
    points += 1;
    weight += w;
    first += w * x;
    second += w * x * x.transpose();
  }
  void Add(const EdgeMoments& other) {
    points += other.points;
    weight += other.weight;
    first += other.first;
    second += other.second;
  }
};

/// A segment in undistorted px, its brighter side on the right as one looks from start to end with
/// y down (the normal (-dy, dx) points to the brighter side).
struct EdgeSegment {
  Eigen::Vector2d start_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d end_px = Eigen::Vector2d::Zero();
  /// Standard deviation of either end point across the line, from the scatter of the edge points.
  double sigma_px = 0;
  EdgeMoments moments;

  double Length() const { return (end_px - start_px).norm(); }
  Eigen::Vector2d Direction() const { return (end_px - start_px).normalized(); }
};

struct EdgeFitOptions {
  /// Points looked at along one fragment at most; a longer one is sampled more sparsely.
  int max_points = 64;
  /// Least central difference I(x + 1) - I(x - 1) of an edge point.
  int min_difference = 6;
  /// Points further from the line than this are left out in the second round.
  double max_residual_px = 1.0;
  /// Fewer points make no segment.
  int min_points = 8;
  /// Points closer than this along the line have dependent errors (blur, compression).
  double correlation_length_px = 3.0;
  /// Floor of EdgeSegment::sigma_px.
  double min_sigma_px = 0.1;

  /// Fragments merge whose ends lie this close to the other's line ...
  double merge_distance_px = 1.5;
  /// ... and whose gap is at most this, and at most half the longer one.
  double merge_gap_px = 15.0;

  template <class V>
  void Visit(V& v) {
    v("max_points", max_points);
    v("min_difference", min_difference);
    v("max_residual_px", max_residual_px);
    v("min_points", min_points);
    v("correlation_length_px", correlation_length_px);
    v("min_sigma_px", min_sigma_px);
    v("merge_distance_px", merge_distance_px);
    v("merge_gap_px", merge_gap_px);
  }
  std::optional<std::string> Validate() const;
};

/// nullopt where too few edge points support the fragment.
std::optional<EdgeSegment> FitSegment(const cv::Mat& gray, const Camera& camera,
                                      const RawSegment& raw, const EdgeFitOptions& options);

/// Merges collinear neighbours of the same polarity, longest first.
std::vector<EdgeSegment> MergeSegments(std::vector<EdgeSegment> segments,
                                       const EdgeFitOptions& options);

}  // namespace vpslam
