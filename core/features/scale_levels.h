// The scales of the image pyramid: what a key point's octave says about its size, its accuracy and
// its distance.
//
// Level o is the image made smaller by scale(o) = factor^o. A corner found there is accurate to
// about scale(o) level-0 px, hence sigma2(o) = scale(o)^2, in units of the variance on level 0.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace vpslam {

class ScalePyramid {
 public:
  ScalePyramid(int num_levels, double factor) : factor_(factor), log_factor_(std::log(factor)) {
    scales_.reserve(num_levels);
    double scale = 1.0;
    for (int i = 0; i < num_levels; ++i, scale *= factor) scales_.push_back(scale);
  }

  int num_levels() const { return static_cast<int>(scales_.size()); }
  double factor() const { return factor_; }
  /// Size of a pixel of the level in level-0 px.
  double scale(int octave) const { return scales_[octave]; }
  /// Variance of a key point's position, in (level-0 sigma)^2.
  double sigma2(int octave) const { return scales_[octave] * scales_[octave]; }

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
  std::vector<double> scales_;
};

}  // namespace vpslam
