// Images for the tests of the features.
#pragma once

#include <cmath>
#include <random>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/geometry/camera.h"

namespace vpslam {

inline Camera PinholeCamera(int width = 640, int height = 480) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = 0.8 * width;
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  return camera;
}

/// Rectangles of random size, direction and grey value, one over the other, with softened edges:
/// corners at all scales.
inline cv::Mat TexturedImage(int width, int height, unsigned seed) {
  std::mt19937 rng(seed);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(rng);
  };
  cv::Mat image(height, width, CV_8UC1, cv::Scalar(128));
  const int count = width * height / 150;
  for (int i = 0; i < count; ++i) {
    const cv::RotatedRect r(
        cv::Point2f(static_cast<float>(uniform(0, width)), static_cast<float>(uniform(0, height))),
        cv::Size2f(static_cast<float>(uniform(4, 40)), static_cast<float>(uniform(4, 40))),
        static_cast<float>(uniform(0, 360)));
    cv::Point2f vertices[4];
    r.points(vertices);
    cv::Point points[4];
    for (int k = 0; k < 4; ++k) points[k] = vertices[k];
    cv::fillConvexPoly(image, points, 4, cv::Scalar(std::floor(uniform(0, 256))), cv::LINE_AA);
  }
  cv::GaussianBlur(image, image, {}, 0.7);
  return image;
}

}  // namespace vpslam
