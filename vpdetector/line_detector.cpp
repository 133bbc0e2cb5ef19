#include "vpdetector/line_detector.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc.hpp>

namespace vpslam {
namespace {

std::vector<cv::Vec4f> DetectLsd(const cv::Mat& gray, const LineDetectorOptions& options) {
  std::vector<cv::Vec4f> lines;
  // Without LSD's own refinement: the fit to the edge's points that follows is the better one.
  cv::createLineSegmentDetector(cv::LSD_REFINE_NONE, options.lsd_scale)->detect(gray, lines);
  return lines;
}

std::vector<cv::Vec4f> DetectEdLines(const cv::Mat& gray, const LineDetectorOptions& options) {
  const auto detector = cv::ximgproc::createEdgeDrawing();
  cv::ximgproc::EdgeDrawing::Params params;
  params.EdgeDetectionOperator = cv::ximgproc::EdgeDrawing::PREWITT;
  params.GradientThresholdValue = options.edlines_gradient;
  params.AnchorThresholdValue = 8;  // [Akinlar11]
  params.MinLineLength = std::max(5, static_cast<int>(options.min_length_px));
  detector->setParams(params);
  detector->detectEdges(gray);
  std::vector<cv::Vec4f> lines;
  detector->detectLines(lines);
  return lines;
}

std::vector<cv::Vec4f> DetectFld(const cv::Mat& gray, const LineDetectorOptions& options) {
  std::vector<cv::Vec4f> lines;
  cv::ximgproc::createFastLineDetector(std::max(5, static_cast<int>(options.min_length_px)), 1.414f,
                                       options.fld_canny_low, options.fld_canny_high, 3, false)
      ->detect(gray, lines);
  return lines;
}

}  // namespace

std::optional<LineDetectorKind> LineDetectorKindFromName(const std::string& name) {
  for (const auto kind :
       {LineDetectorKind::kLsd, LineDetectorKind::kEdLines, LineDetectorKind::kFld}) {
    if (name == Name(kind)) return kind;
  }
  return std::nullopt;
}

const char* Name(LineDetectorKind kind) {
  switch (kind) {
    case LineDetectorKind::kLsd:
      return "lsd";
    case LineDetectorKind::kEdLines:
      return "edlines";
    case LineDetectorKind::kFld:
      return "fld";
  }
  return "?";
}

std::optional<std::string> LineDetectorOptions::Validate() const {
  if (!(min_length_px >= 5 && min_length_px <= 1000)) return "min_length_px must lie in 5 to 1000";
  if (!(lsd_scale >= 0.1 && lsd_scale <= 1)) return "lsd_scale must lie in 0.1 to 1";
  if (edlines_gradient < 1 || edlines_gradient > 1000) {
    return "edlines_gradient must lie in 1 to 1000";
  }
  if (!(fld_canny_low > 0 && fld_canny_high >= fld_canny_low)) {
    return "fld_canny_low must be positive and at most fld_canny_high";
  }
  return std::nullopt;
}

std::vector<RawSegment> DetectSegments(const cv::Mat& image, const LineDetectorOptions& options) {
  CV_Assert(image.type() == CV_8UC1);
  std::vector<RawSegment> segments;
  if (image.cols < 8 || image.rows < 8) return segments;
  // EdgeDrawing takes it for granted that rows follow one another in memory, and OpenCV's filters
  // look beyond the border of a part of a larger image.
  const cv::Mat gray = image.isContinuous() && !image.isSubmatrix() ? image : image.clone();
  std::vector<cv::Vec4f> found;
  switch (options.kind) {
    case LineDetectorKind::kLsd:
      found = DetectLsd(gray, options);
      break;
    case LineDetectorKind::kEdLines:
      found = DetectEdLines(gray, options);
      break;
    case LineDetectorKind::kFld:
      found = DetectFld(gray, options);
      break;
  }
  segments.reserve(found.size());
  for (const cv::Vec4f& f : found) {
    const RawSegment segment{{f[0], f[1]}, {f[2], f[3]}};
    if (!segment.start_px.allFinite() || !segment.end_px.allFinite()) continue;
    if (segment.Length() >= options.min_length_px) segments.push_back(segment);
  }
  return segments;
}

}  // namespace vpslam
