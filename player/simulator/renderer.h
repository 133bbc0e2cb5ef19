// Renders a scene through a pinhole lens with distortion, on the CPU, deterministically.
//
// A parallelogram o + a u + b v in camera coordinates is seen along the ray d (with d.z = 1) where
// z d = o + a u + b v. With M = (u v o) that is (a/z, b/z, 1/z) = M^-1 d: inside test, texture
// coordinates and depth are all linear in the ray, before one division. So the renderer tests each
// pixel's own ray, which makes lens distortion exact, and keeps 1/z in a z-buffer.
//
// A frame is the mean of kSubFrames pictures, each with its own sub-pixel offset and its own moment
// within the exposure: that gives anti-aliasing and motion blur at once.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "core/geometry/camera.h"
#include "core/geometry/se3.h"
#include "player/simulator/light.h"
#include "player/simulator/scene.h"

namespace vpslam::simulator {

class Renderer {
 public:
  static constexpr int kSubFrames = 4;
  /// world_from_cam at the moments SubFrameTime(0), SubFrameTime(1), ...
  using Exposure = std::array<SE3, kSubFrames>;

  /// Bakes the light. The lens must be invertible over the whole image, plus half a pixel.
  Renderer(Scene scene, const Camera& camera);

  /// Moment of a sub-frame in units of the exposure time, from its middle: in [-1/2, 1/2].
  static double SubFrameTime(int sub_frame) { return (sub_frame + 0.5) / kSubFrames - 0.5; }

  /// Radiance as the lens lays it on the image, without blur or noise; 1 is white paper well lit.
  cv::Mat1f Radiance(const Exposure& world_from_cam);

  /// Depth z along the optical axis at pixel centres, m; 0 where nothing is seen.
  cv::Mat1f Depth(const SE3& world_from_cam);

  const Scene& scene() const { return scene_; }

 private:
  /// Rays of a grid of samples, one per pixel, and bounds that find a quad's samples quickly.
  struct RayGrid {
    std::vector<float> x, y;  // d = (x, y, 1), row by row
    std::vector<float> row_min_y, row_max_y;
    // Columns whose ray may have a given x: index by (x - table_min) * table_scale.
    std::vector<int> first_column, last_column;
    float table_min = 0, table_scale = 0;
  };
  /// A quad as one camera pose sees it.
  struct VisibleQuad {
    // a/z, b/z and 1/z as linear forms of the ray (x, y, 1).
    Eigen::Vector3f a, b, w;
    Eigen::Vector3f normal;      // camera frame, towards the viewer
    float min_y = 0, max_y = 0;  // range of the ray's y
    float lod_offset = 0;        // see LodOffset
    int index = 0;               // in scene_.quads
  };

  RayGrid MakeRays(const Eigen::Vector2d& offset_px) const;
  void FindVisible(const SE3& world_from_cam);
  void Rasterise(const RayGrid& rays);
  template <bool kWraps>
  void ShadeRun(const VisibleQuad& visible, const RayGrid& rays, size_t begin, size_t end,
                float lod_dither, float* sum) const;
  void Shade(const RayGrid& rays, float lod_dither, float* sum) const;
  /// Radiance of the lamps mirrored at a sample of a perfectly glossy quad.
  float Gloss(const VisibleQuad& visible, const RayGrid& rays, size_t sample) const;
  void AddGloss(const VisibleQuad& visible, const RayGrid& rays, size_t begin, size_t end,
                float* sum) const;

  Scene scene_;
  Camera camera_;
  std::vector<LightMap> light_;
  std::array<RayGrid, kSubFrames> sub_frame_rays_;
  RayGrid centre_rays_;

  // Working memory of one sub-frame.
  std::vector<VisibleQuad> visible_;
  std::vector<Eigen::Vector3f> lamps_in_cam_;  // their centres
  std::vector<float> inverse_depth_;
  std::vector<int32_t> owner_;  // index into visible_, -1: nothing
};

}  // namespace vpslam::simulator
