#include "player/simulator/materials.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "player/simulator/noise_image.h"
#include "player/simulator/random.h"

namespace vpslam::simulator {
namespace {

constexpr int kLarge = 1024;
constexpr int kSmall = 512;

/// Keeps a reflectance physical.
cv::Mat1f Limited(const cv::Mat1f& image) { return cv::min(cv::max(image, 0.015), 0.92); }

/// Paints `count` short strokes of lighter or darker colour: scuffs, flecks, dents.
void Scuff(cv::Mat1f& factor, int count, double max_length, double strength, Random& random) {
  for (int i = 0; i < count; ++i) {
    const double length = random.Uniform(0.2, 1) * max_length;
    const double angle = random.Uniform(0, 3.1416);
    const double x = random.Uniform(0, factor.cols), y = random.Uniform(0, factor.rows);
    const double f = 1 + strength * random.Uniform(-1, 0.6);
    cv::line(factor, cv::Point2d(x, y),
             cv::Point2d(x + length * std::cos(angle), y + length * std::sin(angle)), f,
             1 + random.Below(2));
  }
}

}  // namespace

cv::Mat1f Plaster(float reflectance, uint64_t seed) {
  Random random(seed);
  const cv::Size size(kLarge, kLarge);
  cv::Mat1f factor = cv::Mat1f::ones(size);
  Scuff(factor, 60, 26, 0.16, random);
  cv::GaussianBlur(factor, factor, {0, 0}, 1.0, 1.0, cv::BORDER_REFLECT);
  factor += 0.045 * FractalNoise(size, 3, 3, 4, 0.6, random.Next());
  factor += 0.03 * FractalNoise(size, 128, 128, 2, 0.7, random.Next());
  return Limited(reflectance * factor);
}

cv::Mat1f Wood(float reflectance, uint64_t seed) {
  Random random(seed);
  const cv::Size size(kLarge, kSmall);
  // Growth rings cut lengthwise: lines of equal (distance to the pith + slow wobble).
  const cv::Mat1f wobble = FractalNoise(size, 2, 4, 3, 0.45, random.Next());
  const cv::Mat1f streaks = FractalNoise(size, 4, 128, 2, 0.6, random.Next());
  const cv::Mat1f pores = NoiseLayer(size, 24, 256, random.Next());
  const double rings = 9 + random.Below(6);
  struct Knot {
    double x, y, radius;
  };
  std::vector<Knot> knots;
  const int knot_count = 2 + random.Below(3);
  for (int i = 0; i < knot_count; ++i) {
    knots.push_back(
        {random.Uniform(0, size.width), random.Uniform(0, size.height), random.Uniform(8, 18)});
  }
  cv::Mat1f image(size);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      double phase = rings * (y + 0.5) / size.height + 1.6 * wobble(y, x);
      double dark = 0;
      for (const Knot& knot : knots) {
        double dx = std::abs(x - knot.x), dy = std::abs(y - knot.y);
        dx = std::min(dx, size.width - dx) * 0.45;
        dy = std::min(dy, size.height - dy);
        const double r2 = (dx * dx + dy * dy) / (knot.radius * knot.radius);
        if (r2 > 20) continue;
        phase += 2.2 * std::exp(-0.35 * r2);
        dark += 0.5 * std::exp(-2.5 * r2);
      }
      const double saw = phase - std::floor(phase);  // early wood fades into a dark late line
      const double ring = saw * saw * saw;
      const double pore = pores(y, x) > 0.45 ? 0.10 : 0;
      image(y, x) = static_cast<float>(reflectance *
                                       (1.1 - 0.28 * ring + 0.10 * streaks(y, x) - pore - dark));
    }
  }
  return Limited(image);
}

cv::Mat1f Parquet(float reflectance, int rows, uint64_t seed) {
  Random random(seed);
  const cv::Mat1f wood = Wood(reflectance, random.Next());
  cv::Mat1f image(kLarge, kLarge);
  for (int row = 0; row < rows; ++row) {
    const int top = row * kLarge / rows, height = (row + 1) * kLarge / rows - top;
    int x = random.Below(kLarge / 3);
    const int start = x;
    while (x < start + kLarge) {
      int length = kLarge / 5 + random.Below(kLarge / 4);
      if (start + kLarge - x - length < kLarge / 6) length = start + kLarge - x;
      const int from_x = random.Below(wood.cols), from_y = random.Below(wood.rows);
      const float tone = static_cast<float>(random.Uniform(0.82, 1.14));
      for (int dy = 0; dy < height; ++dy) {
        for (int dx = 0; dx < length; ++dx) {
          const bool joint = dy == 0 || dx == 0;
          image(top + dy, (x + dx) % kLarge) =
              (joint ? 0.45f : tone) * wood((from_y + dy) % wood.rows, (from_x + dx) % wood.cols);
        }
      }
      x += length;
    }
  }
  return Limited(image);
}

cv::Mat1f Carpet(float reflectance, uint64_t seed) {
  Random random(seed);
  const cv::Size size(kLarge, kLarge);
  cv::Mat1f factor = cv::Mat1f::ones(size);
  Scuff(factor, 2500, 7, 0.45, random);
  factor += 0.22 * WhiteNoise(size, random.Next());
  factor += 0.10 * FractalNoise(size, 5, 5, 4, 0.7, random.Next());
  return Limited(reflectance * factor);
}

cv::Mat1f Linoleum(float reflectance, uint64_t seed) {
  Random random(seed);
  const cv::Size size(kLarge, kLarge);
  cv::Mat1f factor = cv::Mat1f::ones(size);
  Scuff(factor, 900, 5, 0.12, random);
  factor += 0.05 * FractalNoise(size, 4, 4, 5, 0.7, random.Next());
  factor += 0.04 * WhiteNoise(size, random.Next());
  return Limited(reflectance * factor);
}

cv::Mat1f Fabric(float reflectance, uint64_t seed) {
  Random random(seed);
  const cv::Size size(kSmall, kSmall);
  const cv::Mat1f warp = NoiseLayer(size, 256, 16, random.Next());
  const cv::Mat1f weft = NoiseLayer(size, 16, 256, random.Next());
  const cv::Mat1f folds = FractalNoise(size, 3, 3, 3, 0.6, random.Next());
  return Limited(reflectance * (1 + 0.14 * warp + 0.14 * weft + 0.10 * folds));
}

cv::Mat1f Lacquer(float reflectance, uint64_t seed) {
  Random random(seed);
  const cv::Size size(kSmall, kSmall);
  cv::Mat1f factor = cv::Mat1f::ones(size);
  Scuff(factor, 18, 14, 0.2, random);
  cv::GaussianBlur(factor, factor, {0, 0}, 0.8, 0.8, cv::BORDER_REFLECT);
  factor += 0.035 * FractalNoise(size, 3, 3, 5, 0.65, random.Next());
  return Limited(reflectance * factor);
}

cv::Mat1f CeilingBoards(float reflectance, uint64_t seed) {
  Random random(seed);
  const cv::Size size(kLarge, kLarge);
  cv::Mat1f factor = cv::Mat1f::ones(size);
  Scuff(factor, 2500, 3, 0.22, random);
  factor += 0.03 * FractalNoise(size, 4, 4, 4, 0.6, random.Next());
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      factor(cv::Rect(column * 256, row * 256, 256, 256)) *= random.Uniform(0.95, 1.03);
    }
  }
  // A bar is 10 texels wide with a shadow gap of 2 on both sides.
  for (const auto& [half, value] : {std::pair(7, 0.5f), std::pair(5, 1.1f)}) {
    for (int at = 0; at < kLarge; ++at) {
      for (int line = 0; line < kLarge; line += 256) {
        for (int d = -half; d < half; ++d) {
          const int across = (line + d + kLarge) % kLarge;
          factor(at, across) = value;
          factor(across, at) = value;
        }
      }
    }
  }
  return Limited(reflectance * factor);
}

}  // namespace vpslam::simulator
