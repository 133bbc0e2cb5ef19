#include "core/geometry/camera.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/geometry/image_mask.h"

namespace vpslam {
namespace {

/// Distorted normalised coordinates, and their derivative by the undistorted ones.
Eigen::Vector2d DistortNormalised(const Camera& c, const Eigen::Vector2d& p,
                                  Eigen::Matrix2d* jacobian) {
  const double x = p.x(), y = p.y();
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (c.k1 + r2 * (c.k2 + r2 * c.k3));
  if (jacobian) {
    const double d_radial = c.k1 + r2 * (2 * c.k2 + r2 * 3 * c.k3);  // by r2
    (*jacobian)(0, 0) = radial + 2 * x * x * d_radial + 2 * c.p1 * y + 6 * c.p2 * x;
    (*jacobian)(0, 1) = 2 * x * y * d_radial + 2 * c.p1 * x + 2 * c.p2 * y;
    (*jacobian)(1, 0) = (*jacobian)(0, 1);
    (*jacobian)(1, 1) = radial + 2 * y * y * d_radial + 6 * c.p1 * y + 2 * c.p2 * x;
  }
  return {x * radial + 2 * c.p1 * x * y + c.p2 * (r2 + 2 * x * x),
          y * radial + c.p1 * (r2 + 2 * y * y) + 2 * c.p2 * x * y};
}

}  // namespace

std::optional<std::string> Camera::Validate() const {
  for (const double v : {fps, fx, fy, cx, cy, k1, k2, p1, p2, k3}) {
    if (!std::isfinite(v)) return "an intrinsic parameter is not a finite number";
  }
  if (width < 16 || height < 16 || width > 16384 || height > 16384) {
    return "width and height must lie in 16 to 16384 px";
  }
  if (fx <= 0 || fy <= 0) return "fx and fy must be positive";
  if (fx > 100.0 * width || fy > 100.0 * height) return "fx or fy is absurdly large";
  if (cx < -width || cx > 2.0 * width || cy < -height || cy > 2.0 * height) {
    return "the principal point lies far outside the image";
  }
  if (fps <= 0 || fps > 10000) return "fps must be more than 0 and at most 10000";
  return ImageMask::Fault(mask_runs, width, height);
}

Eigen::Vector2d Camera::Distort(const Eigen::Vector2d& undistorted_px) const {
  if (!HasDistortion()) return undistorted_px;
  const Eigen::Vector2d d = DistortNormalised(
      *this, {(undistorted_px.x() - cx) / fx, (undistorted_px.y() - cy) / fy}, nullptr);
  return {fx * d.x() + cx, fy * d.y() + cy};
}

std::optional<Eigen::Vector2d> Camera::Undistort(const Eigen::Vector2d& distorted_px) const {
  if (!HasDistortion()) return distorted_px;
  const Eigen::Vector2d target((distorted_px.x() - cx) / fx, (distorted_px.y() - cy) / fy);
  Eigen::Vector2d p = target;
  for (int i = 0; i < 20; ++i) {
    Eigen::Matrix2d jacobian;
    const Eigen::Vector2d error = DistortNormalised(*this, p, &jacobian) - target;
    const double det = jacobian.determinant();
    // A negative determinant: beyond the radius where the polynomial folds over.
    if (!(det > 1e-6)) return std::nullopt;
    const Eigen::Vector2d step = jacobian.inverse() * error;
    p -= step;
    if (step.squaredNorm() < 1e-20) {
      return Eigen::Vector2d(fx * p.x() + cx, fy * p.y() + cy);
    }
  }
  return std::nullopt;
}

Camera::Bounds Camera::UndistortedBounds() const {
  Bounds bounds{0, 0, static_cast<double>(width), static_cast<double>(height)};
  if (!HasDistortion()) return bounds;
  // The image of the border, sampled: barrel and pincushion bend it, so corners alone don't do.
  constexpr int kSteps = 32;
  bool first = true;
  for (int i = 0; i <= kSteps; ++i) {
    const double x = static_cast<double>(width) * i / kSteps;
    const double y = static_cast<double>(height) * i / kSteps;
    const Eigen::Vector2d border[] = {
        {x, 0}, {x, static_cast<double>(height)}, {0, y}, {static_cast<double>(width), y}};
    for (const Eigen::Vector2d& distorted : border) {
      const std::optional<Eigen::Vector2d> u = Undistort(distorted);
      if (!u) continue;
      if (first) bounds = {u->x(), u->y(), u->x(), u->y()};
      first = false;
      bounds.min_x = std::min(bounds.min_x, u->x());
      bounds.min_y = std::min(bounds.min_y, u->y());
      bounds.max_x = std::max(bounds.max_x, u->x());
      bounds.max_y = std::max(bounds.max_y, u->y());
    }
  }
  return bounds;
}

}  // namespace vpslam
