// Periodic value noise as an image: the raw stuff of wood, plaster, carpet and painted scenery.
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace vpslam::simulator {

/// Random values in [-1, 1] on a periodic lattice of cells_x x cells_y, smoothly interpolated to
/// `size`.
cv::Mat1f NoiseLayer(cv::Size size, int cells_x, int cells_y, uint64_t seed);

/// Sum of layers, each with twice the cells and `gain` times the amplitude of the one before;
/// divided by the sum of amplitudes, so that it stays in [-1, 1].
cv::Mat1f FractalNoise(cv::Size size, int cells_x, int cells_y, int octaves, double gain,
                       uint64_t seed);

/// Independent values in [-1, 1].
cv::Mat1f WhiteNoise(cv::Size size, uint64_t seed);

}  // namespace vpslam::simulator
