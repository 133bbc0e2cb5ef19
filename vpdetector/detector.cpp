#include "vpdetector/detector.h"

#include <stdexcept>

#include "core/base/stopwatch.h"

namespace vpslam {
std::optional<std::string> DetectorOptions::Validate() const {
  if (const auto why = lines.Validate()) return "lines: " + *why;
  if (const auto why = descriptors.Validate()) return "descriptors: " + *why;
  if (const auto why = vps.Validate()) return "vps: " + *why;
  return std::nullopt;
}

Detector::Detector(const Camera& camera, const DetectorOptions& options)
    : camera_(camera), options_(options) {
  if (const auto why = camera.Validate()) throw std::invalid_argument("camera: " + *why);
  if (const auto why = options.Validate()) throw std::invalid_argument(*why);
}

LineSet Detector::Detect(const cv::Mat& gray) const {
  if (gray.type() != CV_8UC1) throw std::invalid_argument("the image is not 8-bit grey");
  if (gray.cols != camera_.width || gray.rows != camera_.height) {
    throw std::invalid_argument("the image has " + std::to_string(gray.cols) + " x " +
                                std::to_string(gray.rows) + " px, the camera file says " +
                                std::to_string(camera_.width) + " x " +
                                std::to_string(camera_.height));
  }
  LineSet result;
  Stopwatch watch;
  const std::vector<EdgeSegment> segments = ExtractLines(gray, camera_, options_.lines);
  result.lines_ms = watch.Lap_ms();

  const std::vector<Descriptor> descriptors =
      DescribeLines(gray, camera_, segments, options_.descriptors);
  result.descriptors_ms = watch.Lap_ms();

  const VpEstimate vps = EstimateVanishingPoints(segments, camera_, options_.vps);
  result.vps_ms = watch.Lap_ms();

  result.lines.resize(segments.size());
  for (size_t i = 0; i < segments.size(); ++i) {
    LineSegment& line = result.lines[i];
    line.start_px = segments[i].start_px.cast<float>();
    line.end_px = segments[i].end_px.cast<float>();
    line.sigma_px = static_cast<float>(segments[i].sigma_px);
    line.has_descriptor = i < descriptors.size();
    if (line.has_descriptor) line.descriptor = descriptors[i];
    line.label = vps.labels[i];
  }
  result.vanishing_points = vps.vanishing_points;
  result.manhattan = vps.state;
  if (vps.state != ManhattanState::kNone) {
    result.cam_from_manhattan = Eigen::Quaterniond(vps.cam_from_manhattan).normalized();
    result.covariance_rad2 = vps.covariance_rad2;
  }
  return result;
}

}  // namespace vpslam
