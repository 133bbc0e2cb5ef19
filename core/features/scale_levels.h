// The scales of the image pyramid: what a key point's octave says about its size, its accuracy and
// its distance.
//
// Level o is the image made smaller by scale(o) = factor^o. A corner found there is accurate to
// sigma(o) = scale(o) x sigma_px, sigma_px being the accuracy on level 0.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace vpslam {

class ScalePyramid {
 public:
  ScalePyramid(int num_levels, double factor, double sigma_px = 1.0)
      : factor_(factor), log_factor_(std::log(factor)), sigma_px_(sigma_px) {
    scales_.reserve(num_levels);
    double scale = 1.0;
    for (int i = 0; i < num_levels; ++i, scale *= factor) scales_.push_back(scale);
  }

  int num_levels() const { return static_cast<int>(scales_.size()); }
  double factor() const { return factor_; }
  /// Size of a pixel of the level in level-0 px.
  double scale(int octave) const { return scales_[octave]; }
  /// Standard deviation of a key point's coordinates, level-0 px.
  double sigma_px(int octave) const { return scales_[octave] * sigma_px_; }
  /// Their variance, px^2.
  double sigma2(int octave) const { return sigma_px(octave) * sigma_px(octave); }

  /// Distance at which a point, seen at `octave` from `distance`, would be seen at octave 0. Unit
  /// of length as that of `distance`.
  double MaxDistance(double distance, int octave) const { return distance * scales_[octave]; }
  /// Distance at which a point with that `max_distance` is seen at the last octave.
  double MinDistance(double max_distance) const { return max_distance / scales_.back(); }
  /// Octave at which a point appears from `distance`: the nearest to log(max / distance) /
  /// log(factor) that exists. Inverse of MaxDistance.
  int PredictOctave(double distance, double max_distance) const {
    const double octave = std::round(std::log(max_distance / distance) / log_factor_);
    return static_cast<int>(std::clamp(octave, 0.0, num_levels() - 1.0));
  }

 private:
  double factor_;
  double log_factor_;
  double sigma_px_;
  std::vector<double> scales_;
};

}  // namespace vpslam
