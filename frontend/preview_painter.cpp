#include "frontend/preview_painter.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace vpslam {
namespace {

const std::array<cv::Scalar, 3> kDirectionColours = {
    cv::Scalar(60, 60, 255), cv::Scalar(60, 220, 60), cv::Scalar(255, 110, 60)};  // B, G, R
const cv::Scalar kGrey(170, 170, 170);
const cv::Scalar kPointColour(0, 255, 0);
constexpr int kPointHalfSide_px = 2;
constexpr int kMinWidth = 40;
/// Between two pictures a direction turns by less than this, in the camera.
constexpr double kMinCosine = 0.85;

}  // namespace

std::vector<int> PreviewPainter::ColoursOf(const LineSet& lines) {
  const int count = std::min<int>(3, static_cast<int>(lines.vanishing_points.size()));
  std::vector<int> colours(lines.vanishing_points.size(), -1);
  std::array<bool, 3> taken{};
  // The pairs that fit best, one after the other.
  for (int round = 0; round < count; ++round) {
    double best = kMinCosine;
    int best_vp = -1, best_colour = -1;
    for (int vp = 0; vp < count; ++vp) {
      for (int colour = 0; colour < 3 && colours[vp] < 0; ++colour) {
        if (taken[colour] || !directions_[colour]) continue;
        const double cosine =
            std::abs(lines.vanishing_points[vp].direction_in_cam.dot(*directions_[colour]));
        if (cosine <= best) continue;
        best = cosine;
        best_vp = vp;
        best_colour = colour;
      }
    }
    if (best_vp < 0) break;
    colours[best_vp] = best_colour;
    taken[best_colour] = true;
  }
  for (int vp = 0; vp < count; ++vp) {
    for (int colour = 0; colour < 3 && colours[vp] < 0; ++colour) {
      if (taken[colour]) continue;
      colours[vp] = colour;
      taken[colour] = true;
    }
    directions_[colours[vp]] = lines.vanishing_points[vp].direction_in_cam;
  }
  return colours;
}

cv::Mat PreviewPainter::Paint(const PreviewScene& scene) {
  const double scale = std::min(1.0, static_cast<double>(kMaxWidth) / camera_.width);
  const cv::Size size(std::max(1, cvRound(camera_.width * scale)),
                      std::max(1, cvRound(camera_.height * scale)));
  cv::Mat picture(size, CV_8UC3, cv::Scalar(0, 0, 0));
  if (!scene.image.empty()) {
    cv::Mat small;
    cv::resize(scene.image, small, size, 0, 0, cv::INTER_AREA);
    cv::cvtColor(small, picture, cv::COLOR_GRAY2BGR);
  }
  const auto at = [&](const Eigen::Vector2f& undistorted_px) {
    const Eigen::Vector2d px = camera_.Distort(undistorted_px.cast<double>()) * scale;
    constexpr double kFar = 1e4;  // OpenCV counts in integers
    return cv::Point(cvRound(std::clamp(px.x(), -kFar, kFar)),
                     cvRound(std::clamp(px.y(), -kFar, kFar)));
  };
  if (scene.lines) {
    const std::vector<int> colours = ColoursOf(*scene.lines);
    for (const LineSegment& line : scene.lines->lines) {
      const int colour = line.label >= 0 ? colours[line.label] : -1;
      cv::line(picture, at(line.start_px), at(line.end_px),
               colour >= 0 ? kDirectionColours[colour] : kGrey, colour >= 0 ? 2 : 1, cv::LINE_AA);
    }
  }
  for (const Eigen::Vector2f& point : scene.tracked_px) {
    const cv::Point centre = at(point);
    const cv::Point corner(kPointHalfSide_px, kPointHalfSide_px);
    cv::rectangle(picture, centre - corner, centre + corner, kPointColour, 1);
  }
  return picture;
}

std::vector<uint8_t> CompressToFit(const cv::Mat& picture, std::size_t max_bytes) {
  cv::Mat smaller = picture;
  while (smaller.cols >= kMinWidth) {
    for (const int quality : {80, 60, 40}) {
      std::vector<uint8_t> jpeg;
      cv::imencode(".jpg", smaller, jpeg, {cv::IMWRITE_JPEG_QUALITY, quality});
      if (jpeg.size() <= max_bytes) return jpeg;
    }
    cv::resize(smaller, smaller, {}, 0.7, 0.7, cv::INTER_AREA);
  }
  return {};
}

}  // namespace vpslam
