// Rendered images with exactly known straight edges.
#pragma once

#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/geometry/camera.h"

namespace vpslam {

/// A convex quadrilateral in undistorted px, brighter than what lies behind it if `value` is.
struct Quad {
  std::array<Eigen::Vector2d, 4> corners;  ///< in order of growing angle with y down
  double value;
};

/// Edges are softened over about a pixel, as by a lens; each pixel looks up where its ray comes
/// from, so a distorted camera bends the edges as its lens would.
inline cv::Mat RenderQuads(const Camera& camera, const std::vector<Quad>& quads, double background,
                           double noise = 0, unsigned seed = 1) {
  cv::Mat image(camera.height, camera.width, CV_8UC1);
  std::mt19937 rng(seed);
  std::normal_distribution<double> normal(0, 1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const Eigen::Vector2d p =
          camera.Undistort(Eigen::Vector2d(x, y)).value_or(Eigen::Vector2d(0, 0));
      double value = background;
      for (const Quad& quad : quads) {
        double inside = 1e9;  // signed distance to the border
        for (size_t i = 0; i < 4; ++i) {
          const Eigen::Vector2d a = quad.corners[i];
          const Eigen::Vector2d d = (quad.corners[(i + 1) % 4] - a).normalized();
          inside = std::min(inside, d.x() * (p - a).y() - d.y() * (p - a).x());
        }
        const double share = 1 / (1 + std::exp(-inside / 0.5));
        value += share * (quad.value - value);
      }
      value += noise * normal(rng);
      image.at<uchar>(y, x) = cv::saturate_cast<uchar>(value);
    }
  }
  return image;
}

/// Corners in order of growing angle with y down.
inline Quad TurnedRectangle(const Eigen::Vector2d& middle, double width, double height,
                            double angle_rad, double value) {
  const Eigen::Vector2d u(std::cos(angle_rad), std::sin(angle_rad)), v(-u.y(), u.x());
  const Eigen::Vector2d a = 0.5 * width * u, b = 0.5 * height * v;
  return {{middle - a - b, middle + a - b, middle + a + b, middle - a + b}, value};
}

}  // namespace vpslam
