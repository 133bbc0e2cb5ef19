#include "player/frame_check.h"

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

namespace vpslam {

cv::Mat ToGrey(const cv::Mat& pixels) {
  if (pixels.type() == CV_8UC1) return pixels;
  cv::Mat grey;
  cv::cvtColor(pixels, grey, pixels.channels() == 4 ? cv::COLOR_BGRA2GRAY : cv::COLOR_BGR2GRAY);
  return grey;
}

std::string FaultOfFrame(const cv::Mat& pixels, const Camera& camera,
                         const std::string& camera_name) {
  if (pixels.empty()) return "is empty";
  if (pixels.depth() != CV_8U || pixels.channels() == 2) return "does not have 8-bit pixels";
  if (pixels.cols != camera.width || pixels.rows != camera.height) {
    return fmt::format("is {} x {} px but {} says {} x {}", pixels.cols, pixels.rows, camera_name,
                       camera.width, camera.height);
  }
  return {};
}

}  // namespace vpslam
