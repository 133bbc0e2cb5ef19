// From radiance to grey levels: vignetting, the blur of lens and sensor, noise, the sRGB curve.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "core/geometry/camera.h"

namespace vpslam::simulator {

struct SensorOptions {
  /// Point spread of lens, sensor and demosaicing, px. Hand-held colour cameras have 0.5 to 0.8.
  double blur_sigma_px = 0.55;
  /// Light lost in the image's corner, as a share.
  double vignetting = 0.18;
  /// Factor on the noise; 1 is a small camera in a room, 0 none.
  double noise = 1;
  /// Noise variance of a linear signal s in [0, 1] at noise = 1: shot * s + read^2.
  double shot = 1.5e-4;
  double read = 1e-3;

  std::optional<std::string> Validate() const;
};

class Sensor {
 public:
  Sensor(const Camera& camera, const SensorOptions& options);

  /// The image that the sensor reads out; `seed` chooses its noise.
  cv::Mat1b Expose(const cv::Mat1f& radiance, uint64_t seed) const;

 private:
  SensorOptions options_;
  cv::Mat1f transmission_;       // of the lens, per pixel
  std::vector<float> gaussian_;  // standard normal numbers to draw from
  std::vector<uint8_t> tone_;    // grey level of linear signal i / (size - 1)
};

}  // namespace vpslam::simulator
