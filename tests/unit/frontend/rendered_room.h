// Images of a made-up place, with exact truth: a wall, a floor and boards before the wall, all with
// printed texture. Rendered by ray casting, in milliseconds.
#pragma once

#include <cmath>
#include <vector>

#include <opencv2/core.hpp>

#include "core/geometry/camera.h"
#include "core/geometry/se3.h"
#include "tests/unit/core/features/test_images.h"

namespace vpslam {

class RenderedRoom {
 public:
  explicit RenderedRoom(unsigned seed) {
    camera.width = 480;
    camera.height = 360;
    camera.fx = camera.fy = 400;
    camera.cx = 240;
    camera.cy = 180;
    Add({-5, -4, 6}, {14, 0, 0}, {0, 6, 0}, seed);
    Add({-5, 1.6, 2}, {14, 0, 0}, {0, 0, 4}, seed + 1);
    Add({-1.8, -1.2, 4}, {1.2, 0, 0.3}, {0, 2.2, 0}, seed + 2);
    Add({0.5, -0.9, 3.2}, {0.9, 0, -0.3}, {0, 1.6, 0.1}, seed + 3);
    Add({2.2, -1.4, 4.5}, {1.3, 0, 0}, {0, 2.4, 0.3}, seed + 4);
  }

  Camera camera;

  cv::Mat Render(const SE3& cam_from_world) const {
    cv::Mat1b image(camera.height, camera.width);
    const Eigen::Matrix3d world_from_cam = cam_from_world.RotationMatrix().transpose();
    const Eigen::Vector3d center = cam_from_world.Center();
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const Eigen::Vector3d ray = world_from_cam * camera.Unproject(Eigen::Vector2d(u, v));
        image(v, u) = Trace(center, ray);
      }
    }
    return image;
  }
  cv::Mat Blank() const { return cv::Mat1b(camera.height, camera.width, uint8_t{128}); }

 private:
  struct Board {
    Eigen::Vector3d corner, normal, along_x, along_y;  ///< `along` in texels per unit of length
    cv::Mat1b texture;
  };

  void Add(const Eigen::Vector3d& corner, const Eigen::Vector3d& x, const Eigen::Vector3d& y,
           unsigned seed) {
    const double texels = camera.fx / std::max(3.0, corner.z());  // per unit of length
    Board board{corner, x.cross(y), texels * x.normalized(), texels * y.normalized(), {}};
    board.texture = TexturedImage(static_cast<int>(texels * x.norm()),
                                  static_cast<int>(texels * y.norm()), seed);
    boards_.push_back(board);
  }
  uint8_t Trace(const Eigen::Vector3d& center, const Eigen::Vector3d& ray) const {
    double nearest = 1e9, value = 128;
    for (const Board& b : boards_) {
      const double depth = (b.corner - center).dot(b.normal) / ray.dot(b.normal);
      if (!(depth > 0.1 && depth < nearest)) continue;
      const Eigen::Vector3d x = center + depth * ray - b.corner;
      const double s = b.along_x.dot(x), t = b.along_y.dot(x);
      if (!(s >= 0 && t >= 0 && s < b.texture.cols - 1 && t < b.texture.rows - 1)) continue;
      const int i = static_cast<int>(t), j = static_cast<int>(s);
      const double p = s - j, q = t - i;
      nearest = depth;
      value = (1 - q) * ((1 - p) * b.texture(i, j) + p * b.texture(i, j + 1)) +
              q * ((1 - p) * b.texture(i + 1, j) + p * b.texture(i + 1, j + 1));
    }
    return static_cast<uint8_t>(std::lround(value));
  }

  std::vector<Board> boards_;
};

}  // namespace vpslam
