// What a frame of a video or a camera has to be.
#pragma once

#include <string>

#include <opencv2/core.hpp>

#include "core/geometry/camera.h"

namespace vpslam {

/// 8-bit grey, BGR or BGRA pixels as grey, CV_8UC1; shares the pixels of an image that is grey.
/// Throws cv::Exception for other kinds.
cv::Mat ToGrey(const cv::Mat& pixels);

/// Why `pixels` cannot be played with a calibration; empty if they can.
std::string FaultOfFrame(const cv::Mat& pixels, const Camera& camera,
                         const std::string& camera_name);

}  // namespace vpslam
