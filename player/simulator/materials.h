// Surfaces that have no beginning and no end: reflectance images that continue periodically. Their
// sides are powers of two.
#pragma once

#include <cstdint>

#include <opencv2/core.hpp>

namespace vpslam::simulator {

/// Painted wall: nearly even, with trowel marks, faint stains and a few scuffs. 1024 x 1024.
cv::Mat1f Plaster(float reflectance, uint64_t seed);
/// Boards with grain along x, pores and a few knots. 1024 x 512.
cv::Mat1f Wood(float reflectance, uint64_t seed);
/// Boards laid in staggered rows along x, `rows` over the height. 1024 x 1024.
cv::Mat1f Parquet(float reflectance, int rows, uint64_t seed);
/// Flecked carpet with worn patches. 1024 x 1024.
cv::Mat1f Carpet(float reflectance, uint64_t seed);
/// Smooth floor covering: faint specks and wear. 1024 x 1024.
cv::Mat1f Linoleum(float reflectance, uint64_t seed);
/// Woven cloth. 512 x 512.
cv::Mat1f Fabric(float reflectance, uint64_t seed);
/// Lacquer or plastic: even, with fine dirt. 512 x 512.
cv::Mat1f Lacquer(float reflectance, uint64_t seed);
/// Mineral-fibre ceiling boards in a grid of light bars, 4 x 4 boards. 1024 x 1024; the bars are
/// centred on texel coordinates 0, 256, 512 and 768.
cv::Mat1f CeilingBoards(float reflectance, uint64_t seed);

}  // namespace vpslam::simulator
