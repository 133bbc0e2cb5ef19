#include "player/simulator/noise_image.h"

#include <cmath>
#include <vector>

#include "player/simulator/random.h"

namespace vpslam::simulator {
namespace {

struct Tap {
  int low, high;
  float weight;  // of `high`
};

/// Where the centres of `length` texels lie on a periodic lattice of `cells`.
std::vector<Tap> Taps(int length, int cells) {
  std::vector<Tap> taps(length);
  for (int i = 0; i < length; ++i) {
    const double position = (i + 0.5) * cells / length;
    const int cell = static_cast<int>(position);
    const double f = position - cell;
    taps[i] = {cell % cells, (cell + 1) % cells, static_cast<float>(f * f * (3 - 2 * f))};
  }
  return taps;
}

}  // namespace

cv::Mat1f WhiteNoise(cv::Size size, uint64_t seed) {
  cv::Mat1f noise(size);
  Random random(seed);
  for (float& v : noise) v = static_cast<float>(random.Uniform(-1, 1));
  return noise;
}

cv::Mat1f NoiseLayer(cv::Size size, int cells_x, int cells_y, uint64_t seed) {
  const cv::Mat1f lattice = WhiteNoise({cells_x, cells_y}, seed);
  const std::vector<Tap> columns = Taps(size.width, cells_x);
  const std::vector<Tap> rows = Taps(size.height, cells_y);
  cv::Mat1f image(size);
  for (int y = 0; y < size.height; ++y) {
    const float* top = lattice[rows[y].low];
    const float* bottom = lattice[rows[y].high];
    for (int x = 0; x < size.width; ++x) {
      const Tap& c = columns[x];
      const float a = top[c.low] + c.weight * (top[c.high] - top[c.low]);
      const float b = bottom[c.low] + c.weight * (bottom[c.high] - bottom[c.low]);
      image(y, x) = a + rows[y].weight * (b - a);
    }
  }
  return image;
}

cv::Mat1f FractalNoise(cv::Size size, int cells_x, int cells_y, int octaves, double gain,
                       uint64_t seed) {
  cv::Mat1f sum = cv::Mat1f::zeros(size);
  double amplitude = 1, total = 0;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += amplitude * NoiseLayer(size, cells_x << octave, cells_y << octave, seed + octave);
    total += amplitude;
    amplitude *= gain;
  }
  return sum / total;
}

}  // namespace vpslam::simulator
