// What all the RANSAC loops of this directory share.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

namespace vpslam {

struct RansacOptions {
  int max_iterations = 300;
  /// Never fewer than this: noise makes many an all-inlier sample a bad one.
  int min_iterations = 30;
  /// Probability that an all-inlier sample was drawn before the loop may end early.
  double confidence = 0.999;

  std::optional<std::string> Validate() const {
    if (min_iterations < 1 || max_iterations < min_iterations) {
      return "iterations must satisfy 1 <= min_iterations <= max_iterations";
    }
    if (!(confidence > 0 && confidence < 1)) return "confidence must lie in 0 to 1";
    return std::nullopt;
  }

  template <class V>
  void Visit(V& v) {
    v("max_iterations", max_iterations);
    v("min_iterations", min_iterations);
    v("confidence", confidence);
  }
};

/// How many samples of `sample_size` are enough at this share of inliers.
inline int RequiredIterations(const RansacOptions& options, double inlier_share, int sample_size) {
  const double all_inliers = std::pow(std::clamp(inlier_share, 0.0, 1.0), sample_size);
  double required = options.max_iterations;
  if (all_inliers >= 1.0 - 1e-12) {
    required = 0;
  } else if (all_inliers > 1e-12) {
    required = std::ceil(std::log1p(-options.confidence) / std::log1p(-all_inliers));
  }
  return static_cast<int>(
      std::clamp<double>(required, options.min_iterations, options.max_iterations));
}

}  // namespace vpslam
