#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/features/matcher.h"
#include "core/features/multiversion.h"

namespace vpslam {
namespace {

/// The free features of the second image, as arrays for the test of many against one line.
struct Candidates {
  std::vector<float> x_px, y_px;
  std::vector<float> gate_px2;  ///< allowed squared distance from the line
  std::vector<int32_t> index;
};

Candidates Collect(const Features& second, std::span<const int32_t> second_free,
                   const ScalePyramid& scales, const Eigen::Vector3d& epipole,
                   const TriangulationMatchOptions& options) {
  Candidates c;
  for (const int32_t j : second_free) {
    const Keypoint& k = second.keypoints[j];
    // Cross-multiplied by z: with a sideways motion the epipole is at infinity.
    const Eigen::Vector2d from_epipole = k.Position() * epipole.z() - epipole.head<2>();
    const double min_px = options.min_epipole_px * scales.scale(k.octave);
    if (from_epipole.norm() < min_px * std::abs(epipole.z())) continue;
    c.x_px.push_back(k.x_px);
    c.y_px.push_back(k.y_px);
    c.gate_px2.push_back(static_cast<float>(options.epipolar_chi2 * scales.sigma2(k.octave)));
    c.index.push_back(j);
  }
  return c;
}

/// near[i] = 1 if candidate i lies within its gate of the line (a, b, c) with a^2 + b^2 = 1.
VPSLAM_MULTIVERSION
void MarkNearLine(const float* x, const float* y, const float* gate, int count, float a, float b,
                  float c, int32_t* near) {
  for (int i = 0; i < count; ++i) {
    const float d = a * x[i] + b * y[i] + c;
    near[i] = d * d <= gate[i];
  }
}

}  // namespace

std::vector<Match> MatchForTriangulation(const Features& first, std::span<const int32_t> first_free,
                                         const Features& second,
                                         std::span<const int32_t> second_free,
                                         const SE3& second_from_first, const Camera& camera,
                                         const ScalePyramid& scales,
                                         const TriangulationMatchOptions& options) {
  std::vector<Match> matches;
  const Eigen::Vector3d& t = second_from_first.translation;
  if (!(t.norm() > 0)) return matches;
  const Eigen::Vector3d baseline = t.normalized();
  const Eigen::Matrix3d k = camera.K(), k_inverse = k.inverse();
  // Line in the second image of x in the first: F x, with F = K^-T [t]_x R K^-1.
  const Eigen::Matrix3d fundamental =
      k_inverse.transpose() * Skew(baseline) * second_from_first.RotationMatrix() * k_inverse;
  const Candidates candidates = Collect(second, second_free, scales, k * baseline, options);
  const int count = static_cast<int>(candidates.index.size());

  std::vector<int32_t> near(count);
  std::vector<int32_t> holder(second.size(), -1);
  std::vector<int> held_distance(second.size(), 257);
  for (const int32_t i : first_free) {
    const Keypoint& point = first.keypoints[i];
    const Eigen::Vector3d line = fundamental * Eigen::Vector3d(point.x_px, point.y_px, 1.0);
    const double norm = line.head<2>().norm();
    if (!(norm > 1e-12)) continue;  // the point is the epipole
    const Eigen::Vector3f l = (line / norm).cast<float>();
    MarkNearLine(candidates.x_px.data(), candidates.y_px.data(), candidates.gate_px2.data(), count,
                 l.x(), l.y(), l.z(), near.data());
    int best = -1, best_distance = 257, second_distance = 257;
    for (int n = 0; n < count; ++n) {
      if (!near[n]) continue;
      const int32_t j = candidates.index[n];
      const int d = Distance(first.descriptors[i], second.descriptors[j]);
      if (d < best_distance) {
        second_distance = best_distance;
        best_distance = d;
        best = j;
      } else if (d < second_distance) {
        second_distance = d;
      }
    }
    if (best < 0 || best_distance > options.max_distance) continue;
    if (second_distance <= 256 &&
        static_cast<float>(best_distance) >= options.ratio * static_cast<float>(second_distance)) {
      continue;
    }
    if (best_distance >= held_distance[best]) continue;
    holder[best] = i;
    held_distance[best] = best_distance;
  }
  for (int j = 0; j < second.size(); ++j) {
    if (holder[j] >= 0) matches.push_back({holder[j], j});
  }
  std::sort(matches.begin(), matches.end(),
            [](const Match& a, const Match& b) { return a.first < b.first; });
  if (options.check_rotation) KeepRotationConsistent(first, second, options.rotation, &matches);
  return matches;
}

}  // namespace vpslam
