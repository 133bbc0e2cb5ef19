// Matching of line segments to where a line is expected in an image: by place, direction, overlap
// and descriptor.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/features/features.h"
#include "core/features/line_set.h"

namespace vpslam {

/// A segment in undistorted px, oriented as core/features/line_set.h says.
struct ImageSegment {
  Eigen::Vector2d start_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d end_px = Eigen::Vector2d::Zero();

  double Length() const { return (end_px - start_px).norm(); }
};

inline ImageSegment ToImageSegment(const LineSegment& line) {
  return {line.start_px.cast<double>(), line.end_px.cast<double>()};
}

/// How two segments lie to each other.
struct SegmentRelation {
  double cosine = 0;      ///< of the angle between their directions; -1 for opposite ones
  double overlap_px = 0;  ///< of their extents along the first; below 0 for a gap
  double offset_px =
      0;  ///< largest distance of the second from the first's line where they overlap
};

SegmentRelation Relate(const ImageSegment& a, const ImageSegment& b);

struct LineWindow {
  double max_offset_px = 10;
  double min_cosine = 0.98;  ///< 11.5 degrees
  double min_overlap = 0.3;  ///< of the shorter one's length
  int max_distance = 80;     ///< Hamming
  double ratio = 0.9;        ///< of scores (see below), best to runner-up
};

struct LineMatch {
  int32_t index = -1;
  int distance = 0;  ///< Hamming
};

/// The segment that fits best: the score is the sum of descriptor distance and offset, each as a
/// share of what is allowed. Segments without descriptor, or with `taken` set, don't come into
/// question (`taken` is empty or has one entry per line). Where the runner-up lies
/// on the same line as the best, that is the same edge, broken, and nothing is compared with it.
std::optional<LineMatch> BestLineInWindow(const ImageSegment& predicted,
                                          const Descriptor& descriptor, const LineWindow& window,
                                          const std::vector<LineSegment>& lines,
                                          const std::vector<uint8_t>& taken);

}  // namespace vpslam
