#include "vpdetector/image_tool.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <ostream>
#include <stdexcept>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/base/camera_file.h"
#include "core/base/decode_image.h"

namespace vpslam {
namespace {

namespace fs = std::filesystem;

const char* Name(ManhattanState state) {
  switch (state) {
    case ManhattanState::kNone:
      return "none";
    case ManhattanState::kTwo:
      return "two";
    case ManhattanState::kThree:
      return "three";
  }
  return "?";
}

/// Standard deviation of a direction in its worst direction.
double WorstSigma_deg(const Eigen::Matrix2d& covariance_rad2) {
  const double half_trace = 0.5 * covariance_rad2.trace();
  const double root =
      std::hypot(0.5 * (covariance_rad2(0, 0) - covariance_rad2(1, 1)), covariance_rad2(0, 1));
  return std::sqrt(std::max(0.0, half_trace + root)) * 180.0 / std::numbers::pi;
}

}  // namespace

void WriteLineSet(const std::string& name, const LineSet& set, std::ostream& out) {
  out << fmt::format("image {} lines {} manhattan {}\n", name, set.lines.size(),
                     Name(set.manhattan));
  for (size_t i = 0; i < set.vanishing_points.size(); ++i) {
    const VanishingPoint& vp = set.vanishing_points[i];
    const bool is_axis = i < 3 && set.manhattan != ManhattanState::kNone;
    out << fmt::format("vp {} {} direction {:.6f} {:.6f} {:.6f} support {} sigma_deg {:.3f}\n", i,
                       is_axis ? "axis" : "further", vp.direction_in_cam.x(),
                       vp.direction_in_cam.y(), vp.direction_in_cam.z(), vp.support,
                       WorstSigma_deg(vp.covariance_rad2));
  }
  for (const LineSegment& line : set.lines) {
    out << fmt::format("line {:.2f} {:.2f} {:.2f} {:.2f} label {}\n", line.start_px.x(),
                       line.start_px.y(), line.end_px.x(), line.end_px.y(), line.label);
  }
}

cv::Mat DrawLineSet(const cv::Mat& gray, const Camera& camera, const LineSet& set) {
  // Blue, green, red.
  const std::array<cv::Scalar, 6> axis_colours{cv::Scalar(0, 0, 255),   cv::Scalar(0, 200, 0),
                                               cv::Scalar(255, 64, 0),  cv::Scalar(0, 200, 255),
                                               cv::Scalar(255, 0, 255), cv::Scalar(255, 255, 0)};
  const size_t first = set.manhattan == ManhattanState::kNone ? 3 : 0;
  const cv::Scalar unlabelled(128, 128, 128);
  cv::Mat picture;
  cv::cvtColor(gray, picture, cv::COLOR_GRAY2BGR);
  picture = 0.5 * picture + cv::Scalar::all(127);  // pale, so that colours stand out
  constexpr int kShift = 4;                        // sixteenths of a px
  constexpr double kUnit = 1 << kShift;
  for (const LineSegment& line : set.lines) {
    const cv::Scalar colour =
        line.label < 0
            ? unlabelled
            : axis_colours[(first + static_cast<size_t>(line.label)) % axis_colours.size()];
    const int pieces = camera.HasDistortion() ? 16 : 1;
    std::vector<cv::Point> path;
    for (int i = 0; i <= pieces; ++i) {
      const double f = static_cast<double>(i) / pieces;
      const Eigen::Vector2d x =
          camera.Distort((1 - f) * line.start_px.cast<double>() + f * line.end_px.cast<double>());
      path.emplace_back(static_cast<int>(std::lround(x.x() * kUnit)),
                        static_cast<int>(std::lround(x.y() * kUnit)));
    }
    cv::polylines(picture, path, false, colour, 2, cv::LINE_AA, kShift);
  }
  return picture;
}

void RunImageTool(const ImageToolOptions& options, std::ostream& out) {
  const Camera camera = ReadCameraFile(options.camera_file);
  const Detector detector(camera, options.detector);
  if (!options.draw_directory.empty()) {
    std::error_code error;
    fs::create_directories(options.draw_directory, error);
    if (!fs::is_directory(options.draw_directory)) {
      throw std::runtime_error(options.draw_directory +
                               ": cannot be made; name a writable folder with --draw");
    }
  }
  for (const std::string& file : options.images) {
    const DecodedImage image = DecodeGrey(file);
    if (!image.fault.empty()) {
      throw std::runtime_error(file + ": " + image.fault + "; name readable images with --image");
    }
    LineSet set;
    try {
      set = detector.Detect(image.grey);
    } catch (const std::invalid_argument& e) {
      throw std::runtime_error(file + ": " + e.what() + "; name the matching file with --camera");
    }
    WriteLineSet(file, set, out);
    if (options.draw_directory.empty()) continue;
    const std::string picture =
        (fs::path(options.draw_directory) / (fs::path(file).stem().string() + "_lines.png"))
            .string();
    bool written = false;
    try {
      written = cv::imwrite(picture, DrawLineSet(image.grey, camera, set));
    } catch (const cv::Exception&) {
    }
    if (!written) {
      throw std::runtime_error(picture + ": cannot be written; name a writable folder with --draw");
    }
  }
}

}  // namespace vpslam
