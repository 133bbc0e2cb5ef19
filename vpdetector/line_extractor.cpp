#include "vpdetector/line_extractor.h"

#include <algorithm>
#include <cstddef>

#include "core/geometry/image_mask.h"

namespace vpslam {
namespace {

bool ByLength(const EdgeSegment& a, const EdgeSegment& b) { return a.Length() > b.Length(); }

bool FollowsBorder(const RawSegment& s, const cv::Mat& gray, double border_px) {
  const double right = gray.cols - 1 - border_px, bottom = gray.rows - 1 - border_px;
  return (s.start_px.x() < border_px && s.end_px.x() < border_px) ||
         (s.start_px.y() < border_px && s.end_px.y() < border_px) ||
         (s.start_px.x() > right && s.end_px.x() > right) ||
         (s.start_px.y() > bottom && s.end_px.y() > bottom);
}

/// Cuts fragments off where the mask hides them.
void LeaveOutHidden(const ImageMask& mask, std::vector<RawSegment>* fragments) {
  constexpr double kMargin_px = 2;  // the ends of fragments are uncertain by as much
  std::size_t kept = 0;
  for (const RawSegment& fragment : *fragments) {
    const auto part = LongestSeenPart(mask, fragment.start_px, fragment.end_px, kMargin_px);
    if (part) (*fragments)[kept++] = {part->start_px, part->end_px};
  }
  fragments->resize(kept);
}

}  // namespace

std::optional<std::string> LineExtractorOptions::Validate() const {
  if (const auto why = detector.Validate()) return why;
  if (const auto why = fit.Validate()) return why;
  if (!(min_length_px >= 0)) return "min_length_px must not be negative";
  if (!(border_px >= 0)) return "border_px must not be negative";
  if (!(max_extent >= 1 && max_extent <= 50)) return "max_extent must lie in 1 to 50";
  if (max_lines < 0) return "max_lines must not be negative";
  return std::nullopt;
}

std::vector<EdgeSegment> ExtractLines(const cv::Mat& gray, const Camera& camera,
                                      const LineExtractorOptions& options) {
  std::vector<RawSegment> raw = DetectSegments(gray, options.detector);
  std::erase_if(raw,
                [&](const RawSegment& s) { return FollowsBorder(s, gray, options.border_px); });
  if (const ImageMask mask(camera.mask_runs, gray.cols, gray.rows); mask.HidesAnything()) {
    LeaveOutHidden(mask, &raw);
  }
  const double limit_px = options.max_extent * std::max(gray.cols, gray.rows);
  const auto is_near = [&](const Eigen::Vector2d& x) {
    return x.cwiseAbs().maxCoeff() <= limit_px;
  };
  std::vector<EdgeSegment> segments;
  segments.reserve(raw.size());
  for (const RawSegment& fragment : raw) {
    const auto segment = FitSegment(gray, camera, fragment, options.fit);
    if (segment && is_near(segment->start_px) && is_near(segment->end_px)) {
      segments.push_back(*segment);
    }
  }
  // Merging compares all pairs: four times what may stay bounds it also for pure noise.
  std::stable_sort(segments.begin(), segments.end(), ByLength);
  const auto kept = static_cast<size_t>(options.max_lines);
  if (segments.size() > 4 * kept) segments.resize(4 * kept);
  segments = MergeSegments(std::move(segments), options.fit);
  std::erase_if(segments, [&](const EdgeSegment& s) { return s.Length() < options.min_length_px; });
  std::stable_sort(segments.begin(), segments.end(), ByLength);
  if (segments.size() > kept) segments.resize(kept);
  return segments;
}

}  // namespace vpslam
