#include "player/simulator/renderer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace vpslam::simulator {
namespace {

constexpr double kNear_m = 0.02;
constexpr float kFarInverse = 1e-3f;  // 1 / (1000 m)
// Quads grow by this share of their size, so that rounding leaves no crack between neighbours.
constexpr double kSeam = 2e-6;
constexpr int kColumnTable = 2048;
constexpr float kBackground = 0.02f;
// Four samples a pixel resolve half a level more than one.
constexpr double kLodBias = -0.6;
constexpr int kGlossSquarings = 5;  // exponent 2^5 of the highlight
constexpr size_t kGlossStep = 8;    // samples

/// A rotated grid: in x and in y each of the four quarters of a pixel gets one sample.
constexpr double kOffsets_px[Renderer::kSubFrames][2] = {
    {-0.125, -0.375}, {0.375, -0.125}, {-0.375, 0.125}, {0.125, 0.375}};

/// log2 of a positive number, to 0.09: the exponent, linear between powers of two.
float RoughLog2(float x) {
  return static_cast<float>(std::bit_cast<int32_t>(x)) * 0x1p-23f - 127.0f;
}

}  // namespace

Renderer::Renderer(Scene scene, const Camera& camera)
    : scene_(std::move(scene)),
      camera_(camera),
      light_(BakeLight(scene_)),
      centre_rays_(MakeRays({0, 0})),
      inverse_depth_(static_cast<size_t>(camera.width) * camera.height),
      owner_(inverse_depth_.size()) {
  for (int i = 0; i < kSubFrames; ++i) {
    sub_frame_rays_[i] = MakeRays({kOffsets_px[i][0], kOffsets_px[i][1]});
  }
}

Renderer::RayGrid Renderer::MakeRays(const Eigen::Vector2d& offset_px) const {
  RayGrid rays;
  const int width = camera_.width, height = camera_.height;
  std::vector<float> column_min(width, HUGE_VALF), column_max(width, -HUGE_VALF);
  for (int row = 0; row < height; ++row) {
    float min_y = HUGE_VALF, max_y = -HUGE_VALF;
    for (int column = 0; column < width; ++column) {
      const auto undistorted = camera_.Undistort({column + offset_px.x(), row + offset_px.y()});
      if (!undistorted) throw std::runtime_error("the lens distortion has no inverse");
      const Eigen::Vector3f ray = camera_.Unproject(*undistorted).cast<float>();
      rays.x.push_back(ray.x());
      rays.y.push_back(ray.y());
      min_y = std::min(min_y, ray.y());
      max_y = std::max(max_y, ray.y());
      column_min[column] = std::min(column_min[column], ray.x());
      column_max[column] = std::max(column_max[column], ray.x());
    }
    rays.row_min_y.push_back(min_y);
    rays.row_max_y.push_back(max_y);
  }
  rays.table_min = *std::min_element(column_min.begin(), column_min.end());
  const float table_max = *std::max_element(column_max.begin(), column_max.end());
  rays.table_scale = (kColumnTable - 1) / (table_max - rays.table_min);
  // Entry i answers for x in its whole bin, so both tables err on the safe side.
  for (int i = 0; i < kColumnTable; ++i) {
    const float low = rays.table_min + (i - 1) / rays.table_scale;
    const float high = rays.table_min + (i + 1) / rays.table_scale;
    int first = width, last = -1;
    for (int column = 0; column < width; ++column) {
      if (column_max[column] >= low) first = std::min(first, column);
      if (column_min[column] <= high) last = std::max(last, column);
    }
    rays.first_column.push_back(first);
    rays.last_column.push_back(last);
  }
  return rays;
}

void Renderer::FindVisible(const SE3& world_from_cam) {
  visible_.clear();
  lamps_in_cam_.clear();
  const SE3 cam_from_world = world_from_cam.Inverse();
  const Eigen::Matrix3d rotation = cam_from_world.RotationMatrix();
  for (const Lamp& lamp : scene_.lamps) {
    const Eigen::Vector3d centre = lamp.origin + 0.5 * (lamp.u + lamp.v);
    lamps_in_cam_.push_back((cam_from_world * centre).cast<float>());
  }
  const double left = centre_rays_.table_min - 0.01;
  const double right = left + (kColumnTable + 1) / centre_rays_.table_scale + 0.02;
  const double top = centre_rays_.row_min_y.front() - 0.01;
  const double bottom = centre_rays_.row_max_y.back() + 0.01;
  for (size_t i = 0; i < scene_.quads.size(); ++i) {
    const Quad& quad = scene_.quads[i];
    Eigen::Matrix3d m;  // (u v o)
    m << rotation * quad.u, rotation * quad.v, cam_from_world * quad.origin;
    const Eigen::Vector3d normal = m.col(1).cross(m.col(0));
    const double facing = -normal.dot(m.col(2));  // det(m); > 0 in front of the quad
    if (facing <= 0 && !quad.two_sided) continue;
    if (std::abs(facing) < 1e-9) continue;

    // Outside one side of the view pyramid with all four corners?
    bool in_front = true;
    double min_y = 1e9, max_y = -1e9;
    int outside[5] = {};
    for (int corner = 0; corner < 4; ++corner) {
      const Eigen::Vector3d x = m * Eigen::Vector3d(corner & 1, corner >> 1, 1);
      outside[0] += x.z() < kNear_m;
      outside[1] += x.x() < left * x.z();
      outside[2] += x.x() > right * x.z();
      outside[3] += x.y() < top * x.z();
      outside[4] += x.y() > bottom * x.z();
      in_front = in_front && x.z() > kNear_m;
      min_y = std::min(min_y, x.y() / x.z());
      max_y = std::max(max_y, x.y() / x.z());
    }
    if (std::any_of(std::begin(outside), std::end(outside), [](int n) { return n == 4; })) {
      continue;
    }

    const Eigen::Matrix3d inverse = m.inverse();
    VisibleQuad visible;
    visible.a = inverse.row(0).cast<float>();
    visible.b = inverse.row(1).cast<float>();
    visible.w = inverse.row(2).cast<float>();
    visible.normal = ((facing > 0 ? 1 : -1) * normal.normalized()).cast<float>();
    visible.min_y = in_front ? static_cast<float>(min_y - 1e-4) : -HUGE_VALF;
    visible.max_y = in_front ? static_cast<float>(max_y + 1e-4) : HUGE_VALF;
    // The map from pixels to texels has determinant texels / (f^2 det(m) w^3); its root is the
    // footprint's size. Seen at a slant, the footprint is long: a part of the slant is added, a
    // compromise between blur across and aliasing along it.
    const double texels = std::abs(quad.texel_scale.x() * quad.texel_scale.y());
    const double distance = std::abs(facing) / normal.norm();
    visible.lod_offset =
        static_cast<float>(0.5 * std::log2(texels / (camera_.fx * camera_.fy * std::abs(facing))) -
                           0.25 * std::log2(distance) + kLodBias);
    visible.index = static_cast<int>(i);
    visible_.push_back(visible);
  }
}

void Renderer::Rasterise(const RayGrid& rays) {
  std::fill(inverse_depth_.begin(), inverse_depth_.end(), kFarInverse);
  std::fill(owner_.begin(), owner_.end(), -1);
  const int width = camera_.width, height = camera_.height;
  for (size_t q = 0; q < visible_.size(); ++q) {
    const VisibleQuad& quad = visible_[q];
    const float grow = static_cast<float>(kSeam);
    // The quad is where all of these are >= 0: a, 1 - a, b, 1 - b (times 1/z), and z > near.
    Eigen::Vector3f forms[5] = {quad.a + grow * quad.w, (1 + grow) * quad.w - quad.a,
                                quad.b + grow * quad.w, (1 + grow) * quad.w - quad.b, quad.w};
    const float max_w = static_cast<float>(1 / kNear_m);
    const auto first_row =
        std::lower_bound(rays.row_max_y.begin(), rays.row_max_y.end(), quad.min_y);
    for (int row = static_cast<int>(first_row - rays.row_max_y.begin()); row < height; ++row) {
      if (rays.row_min_y[row] > quad.max_y) break;
      // Range of the ray's x that can satisfy every form somewhere in this row.
      float low = -HUGE_VALF, high = HUGE_VALF;
      for (const Eigen::Vector3f& form : forms) {
        const float rest =
            form.z() + std::max(form.y() * rays.row_min_y[row], form.y() * rays.row_max_y[row]);
        if (form.x() > 0) {
          low = std::max(low, -rest / form.x());
        } else if (form.x() < 0) {
          high = std::min(high, -rest / form.x());
        } else if (rest < 0) {
          high = -HUGE_VALF;
        }
      }
      if (!(low <= high)) continue;
      const float last_bin = kColumnTable - 1;
      const float low_bin = (low - rays.table_min) * rays.table_scale;
      const float high_bin = (high - rays.table_min) * rays.table_scale;
      if (low_bin > last_bin + 1 || high_bin < -1) continue;
      const int begin = rays.first_column[static_cast<int>(std::clamp(low_bin, 0.0f, last_bin))];
      const int end = rays.last_column[static_cast<int>(std::clamp(high_bin, 0.0f, last_bin))] + 1;

      const size_t offset = static_cast<size_t>(row) * width;
      const float* __restrict x = rays.x.data() + offset;
      const float* __restrict y = rays.y.data() + offset;
      float* __restrict depth = inverse_depth_.data() + offset;
      int32_t* __restrict owner = owner_.data() + offset;
      const int32_t id = static_cast<int32_t>(q);
      const float a0 = forms[0].x(), a1 = forms[0].y(), a2 = forms[0].z();
      const float b0 = forms[1].x(), b1 = forms[1].y(), b2 = forms[1].z();
      const float c0 = forms[2].x(), c1 = forms[2].y(), c2 = forms[2].z();
      const float d0 = forms[3].x(), d1 = forms[3].y(), d2 = forms[3].z();
      const float w0 = quad.w.x(), w1 = quad.w.y(), w2 = quad.w.z();
      for (int i = begin; i < end; ++i) {
        const float dx = x[i], dy = y[i];
        const float a = a0 * dx + a1 * dy + a2;
        const float b = b0 * dx + b1 * dy + b2;
        const float c = c0 * dx + c1 * dy + c2;
        const float d = d0 * dx + d1 * dy + d2;
        const float w = w0 * dx + w1 * dy + w2;
        const float ab = a < b ? a : b;
        const float cd = c < d ? c : d;
        const float inside = ab < cd ? ab : cd;
        const bool nearer = (inside >= 0.0f) & (w > depth[i]) & (w < max_w);
        depth[i] = nearer ? w : depth[i];
        owner[i] = nearer ? id : owner[i];
      }
    }
  }
}

float Renderer::Gloss(const VisibleQuad& visible, const RayGrid& rays, size_t sample) const {
  const Eigen::Vector3f ray(rays.x[sample], rays.y[sample], 1);
  const Eigen::Vector3f point = ray / inverse_depth_[sample];
  const Eigen::Vector3f view = ray.normalized();
  const Eigen::Vector3f mirrored = view - 2 * view.dot(visible.normal) * visible.normal;
  float sum = 0;
  for (size_t i = 0; i < lamps_in_cam_.size(); ++i) {
    float c = std::max(0.0f, (lamps_in_cam_[i] - point).normalized().dot(mirrored));
    for (int k = 0; k < kGlossSquarings; ++k) c *= c;
    sum += c * static_cast<float>(scene_.lamps[i].radiance);
  }
  // Schlick's approximation of Fresnel's law, for a refractive index of 1.5.
  const float grazing = 1 + view.dot(visible.normal);
  const float grazing2 = grazing * grazing;
  return sum * (0.04f + 0.96f * grazing2 * grazing2 * grazing);
}

void Renderer::AddGloss(const VisibleQuad& visible, const RayGrid& rays, size_t begin, size_t end,
                        float* sum) const {
  // A highlight is wide: computed every few samples, linear between.
  const float gloss = static_cast<float>(scene_.quads[visible.index].gloss);
  float left = gloss * Gloss(visible, rays, begin);
  sum[begin] += left;
  while (begin + 1 < end) {
    const size_t next = std::min(begin + kGlossStep, end - 1);
    const float right = gloss * Gloss(visible, rays, next);
    const float slope = (right - left) / static_cast<float>(next - begin);
    for (size_t i = begin + 1; i <= next; ++i) {
      sum[i] += left + slope * static_cast<float>(i - begin);
    }
    begin = next;
    left = right;
  }
}

template <bool kWraps>
void Renderer::ShadeRun(const VisibleQuad& visible, const RayGrid& rays, size_t begin, size_t end,
                        float lod_dither, float* sum) const {
  const Quad& quad = scene_.quads[visible.index];
  const Texture& texture = scene_.textures[quad.texture];
  const LightMap& light = light_[visible.index];
  const float max_level = static_cast<float>(texture.levels.size() - 1);
  const float scale_x = static_cast<float>(quad.texel_scale.x());
  const float scale_y = static_cast<float>(quad.texel_scale.y());
  const float offset_x = static_cast<float>(quad.texel_offset.x());
  const float offset_y = static_cast<float>(quad.texel_offset.y());
  const float light_x = static_cast<float>(light.cells_x);
  const float light_y = static_cast<float>(light.cells_y);
  const float lod_offset = visible.lod_offset + lod_dither;
  for (size_t i = begin; i < end; ++i) {
    const float dx = rays.x[i], dy = rays.y[i];
    const float w = inverse_depth_[i];
    const float z = 1 / w;
    const float a =
        std::clamp((visible.a.x() * dx + visible.a.y() * dy + visible.a.z()) * z, 0.0f, 1.0f);
    const float b =
        std::clamp((visible.b.x() * dx + visible.b.y() * dy + visible.b.z()) * z, 0.0f, 1.0f);

    const float lod = lod_offset - 1.75f * RoughLog2(w);
    const int level_index = static_cast<int>(std::clamp(lod, 0.0f, max_level));
    const Texture::Level& level = texture.levels[level_index];
    // Position in the padded image, whose texel (i, j) has its centre at i + 1/2 - 1.
    const float shrink = std::bit_cast<float>((127 - level_index) << 23);
    float tx, ty;
    if constexpr (kWraps) {
      tx = (offset_x + a * scale_x) * shrink + 0.5f;
      ty = (offset_y + b * scale_y) * shrink + 0.5f;
    } else {
      tx = a * static_cast<float>(level.width) + 0.5f;
      ty = b * static_cast<float>(level.height) + 0.5f;
    }
    int ix = static_cast<int>(tx), iy = static_cast<int>(ty);
    const float fx = tx - static_cast<float>(ix), fy = ty - static_cast<float>(iy);
    if constexpr (kWraps) {
      ix &= level.width - 1;
      iy &= level.height - 1;
    }
    const int stride = level.width + 2;
    const float* t = level.texels.data() + iy * stride + ix;
    const float t0 = t[0] + fx * (t[1] - t[0]);
    const float t1 = t[stride] + fx * (t[stride + 1] - t[stride]);
    const float reflectance = t0 + fy * (t1 - t0);

    const float lx = a * light_x, ly = b * light_y;
    const int jx = std::min(static_cast<int>(lx), light.cells_x - 1);
    const int jy = std::min(static_cast<int>(ly), light.cells_y - 1);
    const float gx = lx - static_cast<float>(jx), gy = ly - static_cast<float>(jy);
    const float* l = light.values.data() + jy * (light.cells_x + 1) + jx;
    const float l0 = l[0] + gx * (l[1] - l[0]);
    const float l1 = l[light.cells_x + 1] + gx * (l[light.cells_x + 2] - l[light.cells_x + 1]);
    sum[i] += reflectance * (l0 + gy * (l1 - l0));
  }
  if (quad.gloss > 0) AddGloss(visible, rays, begin, end, sum);
}

void Renderer::Shade(const RayGrid& rays, float lod_dither, float* sum) const {
  const size_t width = static_cast<size_t>(camera_.width);
  for (size_t row = 0; row < owner_.size(); row += width) {
    size_t begin = row;
    while (begin < row + width) {
      const int32_t id = owner_[begin];
      size_t end = begin + 1;
      while (end < row + width && owner_[end] == id) ++end;
      if (id < 0) {
        for (size_t i = begin; i < end; ++i) sum[i] += kBackground;
      } else if (scene_.textures[scene_.quads[visible_[id].index].texture].wraps) {
        ShadeRun<true>(visible_[id], rays, begin, end, lod_dither, sum);
      } else {
        ShadeRun<false>(visible_[id], rays, begin, end, lod_dither, sum);
      }
      begin = end;
    }
  }
}

cv::Mat1f Renderer::Radiance(const Exposure& world_from_cam) {
  cv::Mat1f sum = cv::Mat1f::zeros(camera_.height, camera_.width);
  for (int i = 0; i < kSubFrames; ++i) {
    FindVisible(world_from_cam[i]);
    Rasterise(sub_frame_rays_[i]);
    // A different rounding of the mip level in each sub-frame: their mean blends two levels.
    Shade(sub_frame_rays_[i], (i + 0.5f) / kSubFrames, sum[0]);
  }
  return sum / kSubFrames;
}

cv::Mat1f Renderer::Depth(const SE3& world_from_cam) {
  FindVisible(world_from_cam);
  Rasterise(centre_rays_);
  cv::Mat1f depth(camera_.height, camera_.width);
  for (size_t i = 0; i < owner_.size(); ++i) {
    depth[0][i] = owner_[i] < 0 ? 0.0f : 1 / inverse_depth_[i];
  }
  return depth;
}

}  // namespace vpslam::simulator
