#include "player/simulator/sensor.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "player/simulator/random.h"

namespace vpslam::simulator {
namespace {

constexpr int kGaussianBits = 16;
constexpr int kToneSteps = 1 << 14;

/// IEC 61966-2-1.
double SrgbFromLinear(double x) {
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}

}  // namespace

std::optional<std::string> SensorOptions::Validate() const {
  for (const double v : {blur_sigma_px, vignetting, noise, shot, read}) {
    if (!std::isfinite(v) || v < 0) return "sensor options must be finite and not negative";
  }
  if (vignetting >= 1) return "vignetting must be less than 1";
  return std::nullopt;
}

Sensor::Sensor(const Camera& camera, const SensorOptions& options)
    : options_(options), transmission_(camera.height, camera.width) {
  const double half_diagonal = 0.5 * std::hypot(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double r = std::hypot(x - camera.cx, y - camera.cy) / half_diagonal;
      transmission_(y, x) = static_cast<float>(1 - options.vignetting * r * r);
    }
  }
  Random random(0x5e4503);
  gaussian_.resize(1 << kGaussianBits);
  for (float& g : gaussian_) g = static_cast<float>(random.Gaussian());
  tone_.resize(kToneSteps + 1);
  for (int i = 0; i <= kToneSteps; ++i) {
    tone_[i] = static_cast<uint8_t>(
        std::lround(255 * SrgbFromLinear(static_cast<double>(i) / kToneSteps)));
  }
}

cv::Mat1b Sensor::Expose(const cv::Mat1f& radiance, uint64_t seed) const {
  cv::Mat1f signal;
  cv::GaussianBlur(radiance, signal, {5, 5}, std::max(1e-3, options_.blur_sigma_px));
  cv::Mat1b image(signal.size());
  const float shot = static_cast<float>(options_.shot * options_.noise * options_.noise);
  const float read =
      static_cast<float>(options_.read * options_.read * options_.noise * options_.noise);
  Random random(seed);
  for (int y = 0; y < signal.rows; ++y) {
    const float* s = signal[y];
    const float* t = transmission_[y];
    uint8_t* out = image[y];
    uint64_t bits = 0;
    for (int x = 0; x < signal.cols; ++x) {
      if (x % 4 == 0) bits = random.Next();
      const float g = gaussian_[bits & ((1u << kGaussianBits) - 1)];
      bits >>= kGaussianBits;
      const float clean = s[x] * t[x];
      const float noisy = clean + g * std::sqrt(shot * clean + read);
      out[x] = tone_[static_cast<int>(std::clamp(noisy, 0.0f, 1.0f) * kToneSteps + 0.5f)];
    }
  }
  return image;
}

}  // namespace vpslam::simulator
