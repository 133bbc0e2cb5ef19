// Reflectance of a surface as a mip-mapped image, so that a distant surface is averaged instead of
// aliased (Williams, "Pyramidal parametrics", SIGGRAPH 1983).
#pragma once

#include <vector>

#include <opencv2/core.hpp>

namespace vpslam::simulator {

/// Texel (i, j) of a level covers [i, i + 1) x [j, j + 1). Values are linear reflectance, not
/// gamma-coded grey.
struct Texture {
  struct Level {
    int width = 0;
    int height = 0;
    /// (width + 2) x (height + 2), row by row: a border of one texel spares the bilinear lookup
    /// every test. It repeats the edge, or the opposite side of a texture that wraps.
    std::vector<float> texels;
  };
  std::vector<Level> levels;  ///< each half the size of the one before, down to 1 x 1
  bool wraps = false;         ///< continues periodically; width and height are powers of two then
};

/// Builds the pyramid of `reflectance`.
Texture MakeTexture(const cv::Mat1f& reflectance, bool wraps);

}  // namespace vpslam::simulator
