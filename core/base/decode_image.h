// Reads one image file as grey pixels.
#pragma once

#include <string>
#include <vector>

#include <opencv2/core.hpp>

namespace vpslam {

struct DecodedImage {
  cv::Mat grey;       ///< CV_8UC1; empty if there is a fault
  std::string fault;  ///< what is wrong with the file; empty if nothing is
};

/// Which values of an image with more than 8 bits become 0 and 255.
struct GreyRange {
  int low = 0;
  int high = 0;  ///< 0: what the image itself holds
};

/// Pixels as stored: an orientation tag is not obeyed, since a calibration belongs to the sensor.
/// A file that ends early is a fault, although the JPEG decoder would fill the rest with grey; so
/// are pixels that are no whole numbers. `deep` is for images with more than 8 bits: cameras put
/// 10, 12 or 14 bits into files of 16, which OpenCV would take for almost black. A PGM says its
/// range itself.
DecodedImage DecodeGrey(const std::string& path, const GreyRange& deep = {});

struct DeepPixels {
  std::string path;  ///< the first image with more than 8 bits; empty if there is none
  GreyRange range;   ///< of all of them
};

/// Finds out what range some images of a sequence, which is to be the same for all, have. `high` is
/// the largest number of as many bits as the largest value has. Where the values lie in less than
/// an eighth of that, as those of a thermal camera do, the range is what they lie in and a tenth
/// more.
DeepPixels LookForDeepPixels(const std::vector<std::string>& paths);

}  // namespace vpslam
