// Reads one image file as grey pixels.
#pragma once

#include <string>

#include <opencv2/core.hpp>

namespace vpslam {

struct DecodedImage {
  cv::Mat grey;       ///< CV_8UC1; empty if there is a fault
  std::string fault;  ///< what is wrong with the file; empty if nothing is
};

/// Pixels as stored: an orientation tag is not obeyed, since a calibration belongs to the sensor.
/// A file that ends early is a fault, although the JPEG decoder would fill the rest with grey.
DecodedImage DecodeGrey(const std::string& path);

}  // namespace vpslam
