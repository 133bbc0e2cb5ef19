#include "core/features/edge_shape.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace vpslam {

EdgeShape EdgeShapeAt(const cv::Mat& image, int x, int y) {
  constexpr int kRadius = 3;
  int xx = 0, xy = 0, yy = 0;
  for (int row = y - kRadius; row <= y + kRadius; ++row) {
    const uint8_t* above = image.ptr<uint8_t>(row - 1) + x;
    const uint8_t* here = image.ptr<uint8_t>(row) + x;
    const uint8_t* below = image.ptr<uint8_t>(row + 1) + x;
    for (int column = -kRadius; column <= kRadius; ++column) {
      const int by_x = here[column + 1] - here[column - 1];
      const int by_y = below[column] - above[column];
      xx += by_x * by_x;
      xy += by_x * by_y;
      yy += by_y * by_y;
    }
  }
  const auto sum = static_cast<float>(xx + yy), difference = static_cast<float>(xx - yy);
  const float twice_xy = 2.0f * static_cast<float>(xy);
  const float spread = std::hypot(difference, twice_xy);
  if (!(sum > 0)) return {1, 0};
  // Half the angle of (xx - yy, 2 xy) is where the gradient is strongest; the edge is normal to it.
  constexpr float kPi = std::numbers::pi_v<float>;
  float edge_rad = 0.5f * std::atan2(twice_xy, difference) + kPi / 2;
  if (edge_rad >= kPi) edge_rad -= kPi;
  return {std::max(0.0f, (sum - spread) / (sum + spread)), edge_rad};
}

}  // namespace vpslam
