#include "vpdetector/edge_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include <Eigen/Eigenvalues>

namespace vpslam {
namespace {

/// How far across the fragment the edge is looked for, in px along the minor axis.
constexpr int kReach = 3;

/// The point where the line through `moments` is closest to all points, its direction (sign open),
/// and the mean squared distance.
struct LineThroughPoints {
  Eigen::Vector2d centre;
  Eigen::Vector2d direction;
  double variance_px2;
};

LineThroughPoints FitLine(const EdgeMoments& m) {
  LineThroughPoints line;
  line.centre = m.first / m.weight;
  const Eigen::Matrix2d c = m.second / m.weight - line.centre * line.centre.transpose();
  // Closed form of the 2 x 2 eigenvector to the larger eigenvalue.
  const double angle = 0.5 * std::atan2(2 * c(0, 1), c(0, 0) - c(1, 1));
  line.direction = {std::cos(angle), std::sin(angle)};
  const Eigen::Vector2d normal(-line.direction.y(), line.direction.x());
  line.variance_px2 = std::max(0.0, normal.dot(c * normal));
  return line;
}

/// Lays the ends onto the line through the moments, and sets sigma.
void SetEnds(const Eigen::Vector2d& start, const Eigen::Vector2d& end,
             const EdgeFitOptions& options, EdgeSegment* segment) {
  const LineThroughPoints line = FitLine(segment->moments);
  const Eigen::Vector2d d =
      line.direction.dot(end - start) < 0 ? Eigen::Vector2d(-line.direction) : line.direction;
  segment->start_px = line.centre + d * d.dot(start - line.centre);
  segment->end_px = line.centre + d * d.dot(end - line.centre);
  // A line fitted to n independent points has 4 / n of their variance at its ends, 1 / n in its
  // middle.
  const double independent = std::max(
      2.0, std::min(segment->moments.points, segment->Length() / options.correlation_length_px));
  segment->sigma_px =
      std::max(options.min_sigma_px, 2.0 * std::sqrt(line.variance_px2 / independent));
}

}  // namespace

std::optional<std::string> EdgeFitOptions::Validate() const {
  if (max_points < 8 || max_points > 4096) return "max_points must lie in 8 to 4096";
  if (min_difference < 1 || min_difference > 255) return "min_difference must lie in 1 to 255";
  if (!(max_residual_px > 0)) return "max_residual_px must be positive";
  if (min_points < 3 || min_points > max_points) return "min_points must lie in 3 to max_points";
  if (!(correlation_length_px >= 1)) return "correlation_length_px must be at least 1";
  if (!(min_sigma_px > 0)) return "min_sigma_px must be positive";
  if (!(merge_distance_px >= 0) || !(merge_gap_px >= 0)) {
    return "merge_distance_px and merge_gap_px must not be negative";
  }
  return std::nullopt;
}

std::optional<EdgeSegment> FitSegment(const cv::Mat& gray, const Camera& camera,
                                      const RawSegment& raw, const EdgeFitOptions& options) {
  Eigen::Vector2d a = raw.start_px, b = raw.end_px;
  // Walk along the axis the fragment follows more; look for the edge along the other one.
  const bool along_x = std::abs(b.x() - a.x()) >= std::abs(b.y() - a.y());
  const int major = along_x ? 0 : 1;
  const int minor = 1 - major;
  if (a[major] > b[major]) std::swap(a, b);
  const double slope = (b[minor] - a[minor]) / (b[major] - a[major]);
  const int major_size = along_x ? gray.cols : gray.rows;
  const int minor_size = along_x ? gray.rows : gray.cols;
  const int first = std::max(0, static_cast<int>(std::ceil(a[major])));
  const int last = std::min(major_size - 1, static_cast<int>(std::floor(b[major])));
  const int stride = std::max(1, (last - first + 1 + options.max_points - 1) / options.max_points);
  const ptrdiff_t row_step = static_cast<ptrdiff_t>(gray.step);
  const ptrdiff_t minor_step = along_x ? row_step : 1;
  const ptrdiff_t major_step = along_x ? 1 : row_step;

  // Central differences across the edge at each position of the walk.
  using Profile = std::array<int, 2 * kReach + 1>;
  struct Sample {
    int at;    // on the major axis
    int base;  // the minor coordinate of the profile's centre
    Profile difference;
  };
  std::vector<Sample> samples;
  samples.reserve(static_cast<size_t>(std::max(0, last - first)) / static_cast<size_t>(stride) + 1);
  long polarity = 0;
  for (int at = first; at <= last; at += stride) {
    const int base = static_cast<int>(std::lround(a[minor] + slope * (at - a[major])));
    if (base - kReach - 1 < 0 || base + kReach + 1 >= minor_size) continue;
    const uchar* pixel = gray.data + at * major_step + base * minor_step;
    Sample sample{at, base, {}};
    for (int o = -kReach; o <= kReach; ++o) {
      sample.difference[static_cast<size_t>(o + kReach)] =
          static_cast<int>(pixel[(o + 1) * minor_step]) -
          static_cast<int>(pixel[(o - 1) * minor_step]);
    }
    for (int o = -1; o <= 1; ++o) polarity += sample.difference[static_cast<size_t>(o + kReach)];
    samples.push_back(sample);
  }
  const int sign = polarity >= 0 ? 1 : -1;

  struct EdgePoint {
    Eigen::Vector2d position;
    double weight;
  };
  std::vector<EdgePoint> points;
  points.reserve(samples.size());
  for (const Sample& sample : samples) {
    int peak = 1;
    for (int o = 2; o < 2 * kReach; ++o) {
      if (sign * sample.difference[static_cast<size_t>(o)] >
          sign * sample.difference[static_cast<size_t>(peak)]) {
        peak = o;
      }
    }
    const int top = sign * sample.difference[static_cast<size_t>(peak)];
    if (top < options.min_difference) continue;
    // The centre of gravity over the lobe around the peak: unbiased, as it ends where the gradient
    // does.
    double sum = top, moment = 0;
    for (const int way : {-1, 1}) {
      int previous = top;
      for (int o = peak + way; o >= 0 && o <= 2 * kReach; o += way) {
        const int value = sign * sample.difference[static_cast<size_t>(o)];
        if (value <= 0 || value > previous) break;
        sum += value;
        moment += value * (o - peak);
        previous = value;
      }
    }
    Eigen::Vector2d distorted;
    distorted[major] = sample.at;
    distorted[minor] = sample.base + (peak - kReach) + moment / sum;
    const std::optional<Eigen::Vector2d> undistorted = camera.Undistort(distorted);
    if (undistorted) points.push_back({*undistorted, static_cast<double>(top)});
  }
  if (static_cast<int>(points.size()) < options.min_points) return std::nullopt;

  // Two rounds: the first line may be off by points of other edges.
  EdgeSegment segment;
  for (const EdgePoint& p : points) segment.moments.Add(p.position, p.weight);
  for (int round = 0; round < 2; ++round) {
    const LineThroughPoints line = FitLine(segment.moments);
    const Eigen::Vector2d normal(-line.direction.y(), line.direction.x());
    const double gate = (round == 0 ? 2.0 : 1.0) * options.max_residual_px;
    EdgeMoments kept;
    for (const EdgePoint& p : points) {
      const double q = normal.dot(p.position - line.centre) / gate;
      if (q * q < 1) kept.Add(p.position, p.weight * (1 - q * q));
    }
    if (kept.points < options.min_points) return std::nullopt;
    segment.moments = kept;
  }
  const Eigen::Vector2d ends[] = {a, b};
  std::array<Eigen::Vector2d, 2> undistorted_ends;
  for (size_t i = 0; i < 2; ++i) {
    const std::optional<Eigen::Vector2d> end = camera.Undistort(ends[i]);
    if (!end) return std::nullopt;
    undistorted_ends[i] = *end;
  }
  // `sign` tells whether it gets brighter with growing minor coordinate. With y down and the walk
  // along +x that is the right-hand side; along +y, +x is the left-hand side.
  const bool forward = (sign > 0) == along_x;
  SetEnds(undistorted_ends[forward ? 0 : 1], undistorted_ends[forward ? 1 : 0], options, &segment);
  return segment;
}

std::vector<EdgeSegment> MergeSegments(std::vector<EdgeSegment> segments,
                                       const EdgeFitOptions& options) {
  std::stable_sort(
      segments.begin(), segments.end(),
      [](const EdgeSegment& a, const EdgeSegment& b) { return a.Length() > b.Length(); });
  std::vector<bool> gone(segments.size(), false);
  for (size_t i = 0; i < segments.size(); ++i) {
    if (gone[i]) continue;
    // Again from the start after each merge, since the segment reaches further then.
    bool grew = true;
    while (grew) {
      grew = false;
      EdgeSegment& s = segments[i];
      const Eigen::Vector2d d = s.Direction();
      const Eigen::Vector2d normal(-d.y(), d.x());
      const double length = s.Length();
      for (size_t j = i + 1; j < segments.size(); ++j) {
        if (gone[j]) continue;
        const EdgeSegment& t = segments[j];
        // Cheapest test first: most pairs fail it.
        if (std::abs(normal.dot(t.start_px - s.start_px)) > options.merge_distance_px) continue;
        if (std::abs(normal.dot(t.end_px - s.start_px)) > options.merge_distance_px) continue;
        const double from = d.dot(t.start_px - s.start_px);
        const double to = d.dot(t.end_px - s.start_px);
        if (to <= from) continue;  // the opposite polarity
        const double gap = std::max(from - length, -to);
        if (gap > std::min(options.merge_gap_px, 0.5 * length)) continue;
        EdgeSegment merged;
        merged.moments = s.moments;
        merged.moments.Add(t.moments);
        SetEnds(from < 0 ? t.start_px : s.start_px, to > length ? t.end_px : s.end_px, options,
                &merged);
        // Two edges side by side are no one edge: the points must fit one line as well as a single
        // fragment's do.
        if (std::sqrt(FitLine(merged.moments).variance_px2) > 0.5 * options.max_residual_px) {
          continue;
        }
        segments[i] = merged;
        gone[j] = true;
        grew = true;
        break;
      }
    }
  }
  std::vector<EdgeSegment> result;
  for (size_t i = 0; i < segments.size(); ++i) {
    if (!gone[i]) result.push_back(segments[i]);
  }
  return result;
}

}  // namespace vpslam
