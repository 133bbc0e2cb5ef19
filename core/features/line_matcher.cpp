#include "core/features/line_matcher.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vpslam {

SegmentRelation Relate(const ImageSegment& a, const ImageSegment& b) {
  SegmentRelation relation;
  const Eigen::Vector2d along_a = a.end_px - a.start_px, along_b = b.end_px - b.start_px;
  const double length_a = along_a.norm(), length_b = along_b.norm();
  if (!(length_a > 0) || !(length_b > 0)) return relation;
  const Eigen::Vector2d u = along_a / length_a;
  const Eigen::Vector2d normal(-u.y(), u.x());
  relation.cosine = u.dot(along_b) / length_b;
  const double s0 = u.dot(b.start_px - a.start_px), s1 = u.dot(b.end_px - a.start_px);
  const double o0 = normal.dot(b.start_px - a.start_px), o1 = normal.dot(b.end_px - a.start_px);
  const double from = std::max(0.0, std::min(s0, s1)), to = std::min(length_a, std::max(s0, s1));
  relation.overlap_px = to - from;
  const auto offset_at = [&](double s) {
    const double f = s1 == s0 ? 0.5 : std::clamp((s - s0) / (s1 - s0), 0.0, 1.0);
    return std::abs(o0 + f * (o1 - o0));
  };
  relation.offset_px = std::max(offset_at(from), offset_at(to));
  return relation;
}

std::optional<LineMatch> BestLineInWindow(const ImageSegment& predicted,
                                          const Descriptor& descriptor, const LineWindow& window,
                                          const std::vector<LineSegment>& lines,
                                          const std::vector<uint8_t>& taken) {
  struct Candidate {
    double score = std::numeric_limits<double>::infinity();
    LineMatch match;
  };
  Candidate best, second;
  const double length = predicted.Length();
  for (size_t i = 0; i < lines.size(); ++i) {
    if (!lines[i].has_descriptor || (!taken.empty() && taken[i])) continue;
    const ImageSegment segment = ToImageSegment(lines[i]);
    const SegmentRelation relation = Relate(predicted, segment);
    if (relation.cosine < window.min_cosine || relation.offset_px > window.max_offset_px ||
        relation.overlap_px < window.min_overlap * std::min(length, segment.Length())) {
      continue;
    }
    const int distance = Distance(descriptor, lines[i].descriptor);
    if (distance > window.max_distance) continue;
    const double score = static_cast<double>(distance) / window.max_distance +
                         relation.offset_px / window.max_offset_px;
    Candidate candidate{score, {static_cast<int32_t>(i), distance}};
    if (candidate.score < best.score) std::swap(candidate, best);
    if (candidate.score < second.score) second = candidate;
  }
  if (best.match.index < 0) return std::nullopt;
  if (second.match.index >= 0 && best.score > window.ratio * second.score) {
    constexpr double kSameEdge_px = 2.0;
    const ImageSegment a = ToImageSegment(lines[best.match.index]);
    const ImageSegment b = ToImageSegment(lines[second.match.index]);
    const Eigen::Vector2d u = (a.end_px - a.start_px).normalized();
    const Eigen::Vector2d normal(-u.y(), u.x());
    if (std::abs(normal.dot(b.start_px - a.start_px)) > kSameEdge_px ||
        std::abs(normal.dot(b.end_px - a.start_px)) > kSameEdge_px) {
      return std::nullopt;
    }
  }
  return best.match;
}

}  // namespace vpslam
