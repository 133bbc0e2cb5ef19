#include <algorithm>
#include <cmath>
#include <cstring>

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
                  float c, uint8_t* near) {
  for (int i = 0; i < count; ++i) {
    const float d = a * x[i] + b * y[i] + c;
    near[i] = d * d <= gate[i];
  }
}

constexpr size_t kAtOnce = sizeof(uint64_t);

/// Takes the places that are not 0, ascending. Few are, so that whole words are passed over.
/// marks.size() is a multiple of kAtOnce.
template <class Take>
void ForEachMarked(const std::vector<uint8_t>& marks, const Take& take) {
  for (size_t word = 0; word < marks.size(); word += kAtOnce) {
    uint64_t any = 0;
    std::memcpy(&any, &marks[word], kAtOnce);
    if (any == 0) continue;
    for (size_t i = word; i < word + kAtOnce; ++i) {
      if (marks[i]) take(i);
    }
  }
}

/// Which candidates imply a depth and a change of viewing direction that are possible at all.
/// Infinity is.
class DepthGate {
 public:
  DepthGate(const SE3& second_from_first, const Camera& camera,
            const TriangulationMatchOptions& options)
      : camera_(camera),
        rotation_(second_from_first.RotationMatrix()),
        t_(second_from_first.translation),
        min_depth_(options.min_depth),
        max_sine2_(std::pow(std::sin(options.max_parallax_rad), 2)) {}

  Eigen::Vector3d TurnedRay(const Eigen::Vector2d& first_px) const {
    return rotation_ * camera_.Unproject(first_px);
  }
  /// z ray + t is parallel to the second ray r, so z (r x ray) = -(r x t).
  bool Allows(const Eigen::Vector3d& ray, const Eigen::Vector2d& second_px) const {
    const Eigen::Vector3d r = camera_.Unproject(second_px);
    const Eigen::Vector3d parallax = r.cross(ray);
    const double p2 = parallax.squaredNorm();
    constexpr double kFar = 0.005;  // rad: too little parallax for a depth, on either side of zero
    if (p2 < kFar * kFar) return true;
    if (p2 > max_sine2_ * r.squaredNorm() * ray.squaredNorm()) return false;
    return -parallax.dot(r.cross(t_)) >= min_depth_ * p2;
  }

 private:
  const Camera& camera_;
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d t_;
  double min_depth_;
  double max_sine2_;
};

struct Rival {
  int32_t index = -1;
  int distance = 257;
};

/// The best, if it is near enough and clearly better than the best somewhere else: the same corner
/// is often found on neighbouring octaves, which is no ambiguity.
std::optional<Rival> Choose(const std::vector<Rival>& rivals, const Features& second,
                            const ScalePyramid& scales, const TriangulationMatchOptions& options) {
  Rival best;
  for (const Rival& r : rivals) {
    if (r.distance < best.distance) best = r;
  }
  if (best.index < 0 || best.distance > options.max_distance) return std::nullopt;
  const Keypoint& winner = second.keypoints[best.index];
  const double same_px = options.same_corner_px * scales.scale(winner.octave);
  for (const Rival& r : rivals) {
    if (static_cast<float>(best.distance) < options.ratio * static_cast<float>(r.distance))
      continue;
    if (r.index == best.index) continue;
    const double apart_px = (second.keypoints[r.index].Position() - winner.Position()).norm();
    if (apart_px > same_px) return std::nullopt;
  }
  return best;
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

  const DepthGate depth_gate(second_from_first, camera, options);
  std::vector<uint8_t> near((candidates.index.size() + kAtOnce - 1) / kAtOnce * kAtOnce);
  std::vector<Rival> rivals;
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
    const Eigen::Vector3d ray = depth_gate.TurnedRay(point.Position());
    rivals.clear();
    ForEachMarked(near, [&](size_t n) {
      const int32_t j = candidates.index[n];
      if (!depth_gate.Allows(ray, second.keypoints[j].Position())) return;
      rivals.push_back({j, Distance(first.descriptors[i], second.descriptors[j])});
    });
    const auto winner = Choose(rivals, second, scales, options);
    if (!winner) continue;
    const auto [best, best_distance] = *winner;
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
