#include "core/base/mask_file.h"

#include <stdexcept>

#include <opencv2/core.hpp>

#include "core/base/decode_image.h"
#include "core/geometry/image_mask.h"

namespace vpslam {

std::vector<int32_t> ReadMaskFile(const std::string& path, int width, int height) {
  constexpr double kMiddleGrey = 127;  // pictures that lost something in storage have shades
  const DecodedImage picture = DecodeGrey(path);
  if (!picture.fault.empty()) {
    throw std::runtime_error(path + ": " + picture.fault +
                             "; name a picture that is black where the image is not to be used");
  }
  const cv::Mat& grey = picture.grey;
  if (grey.cols != width || grey.rows != height) {
    throw std::runtime_error(path + ": the mask has " + std::to_string(grey.cols) + " x " +
                             std::to_string(grey.rows) + " px, the camera " +
                             std::to_string(width) + " x " + std::to_string(height) +
                             "; draw it over an image of this camera");
  }
  cv::Mat hidden = grey <= kMiddleGrey;
  const std::vector<int32_t> runs =
      MaskRuns({hidden.ptr<uint8_t>(), static_cast<std::size_t>(hidden.total())});
  if (const auto why = ImageMask::Fault(runs, width, height)) {
    throw std::runtime_error(path + ": " + *why);
  }
  return runs;
}

}  // namespace vpslam
