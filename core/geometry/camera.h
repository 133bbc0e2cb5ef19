// Pinhole camera with radial-tangential (Brown-Conrady) distortion, as OpenCV defines it.
//
// Pixel centres have integer coordinates. Everything behind feature extraction lives in the
// *undistorted* pinhole image, u = fx x/z + cx; only images and detectors know distortion.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace vpslam {

struct Camera {
  int width = 0;
  int height = 0;
  double fps = 30.0;
  double fx = 0, fy = 0, cx = 0, cy = 0;          ///< px
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;  ///< radial k, tangential p; no unit
  /// What moves with the camera, as run lengths (core/geometry/image_mask.h); empty: nothing.
  std::vector<int32_t> mask_runs = {};

  bool HasDistortion() const { return k1 != 0 || k2 != 0 || p1 != 0 || p2 != 0 || k3 != 0; }

  /// Why this is no usable camera (a size or focal length <= 0, a NaN, a mask of another size,
  /// ...); nullopt if it is one.
  std::optional<std::string> Validate() const;

  /// See core/base/description.h.
  static constexpr const char* kWireName = "camera_t";
  static void Describe(auto& v, auto& m) {
    auto& [width, height, fps, fx, fy, cx, cy, k1, k2, p1, p2, k3, mask_runs] = m;
    v("width", width);
    v("height", height);
    v("fps", fps);
    v("fx", fx);
    v("fy", fy);
    v("cx", cx);
    v("cy", cy);
    v("k1", k1);
    v("k2", k2);
    v("k3", k3);
    v("p1", p1);
    v("p2", p2);
    v.Array("num_mask_runs", "mask_runs", mask_runs);
  }

  /// Undistorted pixel of a point in camera coordinates; the caller makes sure that z > 0.
  Eigen::Vector2d Project(const Eigen::Vector3d& x_cam) const {
    return {fx * x_cam.x() / x_cam.z() + cx, fy * x_cam.y() / x_cam.z() + cy};
  }
  /// Ray of an undistorted pixel, with z = 1.
  Eigen::Vector3d Unproject(const Eigen::Vector2d& x_px) const {
    return {(x_px.x() - cx) / fx, (x_px.y() - cy) / fy, 1.0};
  }
  /// Where the lens really puts an undistorted pixel.
  Eigen::Vector2d Distort(const Eigen::Vector2d& undistorted_px) const;
  /// Inverse of Distort, by Newton's method; nullopt where the model folds over and has no inverse.
  std::optional<Eigen::Vector2d> Undistort(const Eigen::Vector2d& distorted_px) const;

  /// Bounding box, in undistorted px, of what the image shows.
  struct Bounds {
    double min_x, min_y, max_x, max_y;
    bool Contains(const Eigen::Vector2d& x) const {
      return x.x() >= min_x && x.x() < max_x && x.y() >= min_y && x.y() < max_y;
    }
  };
  Bounds UndistortedBounds() const;

  Eigen::Matrix3d K() const {
    Eigen::Matrix3d k;
    k << fx, 0, cx, 0, fy, cy, 0, 0, 1;
    return k;
  }
};

}  // namespace vpslam
