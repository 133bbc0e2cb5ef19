// Straight edges of an image as raw fragments, by one of the packaged detectors.
//
// LSD: [vonGioi10] R. Grompone von Gioi et al., "LSD: A Fast Line Segment Detector with a False
// Detection Control", PAMI 2010. EDLines: [Akinlar11] C. Akinlar, C. Topal, "EDLines: A real-time
// line segment detector with a false detection control", PRL 2011. FLD: [Lee14] J. H. Lee et al.,
// "Outdoor place recognition in urban environments using straight lines", ICRA 2014.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace vpslam {

enum class LineDetectorKind { kLsd, kEdLines, kFld };

/// "lsd", "edlines", "fld"; nullopt for anything else.
std::optional<LineDetectorKind> LineDetectorKindFromName(const std::string& name);
const char* Name(LineDetectorKind kind);

struct LineDetectorOptions {
  LineDetectorKind kind = LineDetectorKind::kEdLines;
  /// Shorter fragments are dropped at once.
  double min_length_px = 15.0;
  /// LSD works on the image scaled by this: 0.5 takes 9 ms where the usual 0.8 takes 20 ms.
  double lsd_scale = 0.5;
  /// EDLines: gradient (Prewitt, 0 to 255 * 6) below which a pixel belongs to no edge.
  int edlines_gradient = 30;
  /// FLD: thresholds of its Canny edge detector.
  double fld_canny_low = 50.0;
  double fld_canny_high = 50.0;

  template <class V>
  void Visit(V& v) {
    v("kind", kind);
    v("min_length_px", min_length_px);
    v("lsd_scale", lsd_scale);
    v("edlines_gradient", edlines_gradient);
    v("fld_canny_low", fld_canny_low);
    v("fld_canny_high", fld_canny_high);
  }
  std::optional<std::string> Validate() const;
};

/// A fragment in the pixels of the image it was found in; its two ends come in no special order.
struct RawSegment {
  Eigen::Vector2d start_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d end_px = Eigen::Vector2d::Zero();

  double Length() const { return (end_px - start_px).norm(); }
};

/// `image` is CV_8UC1. Images under 8 px a side hold no segment. The result depends on the image
/// and the options alone.
std::vector<RawSegment> DetectSegments(const cv::Mat& image, const LineDetectorOptions& options);

}  // namespace vpslam
