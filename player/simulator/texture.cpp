#include "player/simulator/texture.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace vpslam::simulator {

Texture MakeTexture(const cv::Mat1f& reflectance, bool wraps) {
  Texture texture;
  texture.wraps = wraps;
  cv::Mat1f image = reflectance;
  while (true) {
    cv::Mat1f padded;
    cv::copyMakeBorder(image, padded, 1, 1, 1, 1, wraps ? cv::BORDER_WRAP : cv::BORDER_REPLICATE);
    Texture::Level level;
    level.width = image.cols;
    level.height = image.rows;
    level.texels.assign(padded.begin(), padded.end());
    texture.levels.push_back(std::move(level));
    if (image.cols == 1 && image.rows == 1) return texture;
    cv::Mat1f half;
    cv::resize(image, half, {std::max(1, image.cols / 2), std::max(1, image.rows / 2)}, 0, 0,
               cv::INTER_AREA);
    image = half;
  }
}

}  // namespace vpslam::simulator
