#include "frontend/initializer.h"

#include <algorithm>
#include <numbers>

#include "core/features/manhattan_quality.h"
#include "core/features/matcher.h"
#include "core/geometry/axis_naming.h"
#include "core/geometry/so3.h"

namespace vpslam {
namespace {

InitialMap MakeInitialMap(const Frame& first, const std::vector<Match>& matches,
                          const TwoViewCandidate& motion) {
  InitialMap map{first, {}, {}};
  std::vector<double> depths;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (!motion.point[i]) continue;
    map.points.push_back({matches[i].first, matches[i].second, *motion.point[i]});
    depths.push_back(motion.point[i]->z());
  }
  const auto middle = depths.begin() + static_cast<int>(depths.size()) / 2;
  std::nth_element(depths.begin(), middle, depths.end());
  const double scale = 1.0 / *middle;
  for (InitialPoint& p : map.points) p.position_in_world *= scale;
  map.second_from_first =
      SE3(motion.second_from_first.rotation, motion.second_from_first.translation * scale);
  return map;
}

template <class T>
void Remove(const std::vector<bool>& unwanted, std::vector<T>* values) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < unwanted.size(); ++i) {
    if (!unwanted[i]) (*values)[kept++] = (*values)[i];
  }
  values->resize(kept);
}

constexpr double kRadPerDeg = std::numbers::pi / 180;
constexpr int kMinSupport = 5;
constexpr double kMaxSigma_rad = 1.0 * kRadPerDeg;

/// Between a motion's rotation and the one that the Manhattan axes of both views show.
double VpDifference_rad(const Eigen::Quaterniond& second_from_first, const LineSet& first,
                        const LineSet& second) {
  const Eigen::Quaterniond predicted = second_from_first * first.cam_from_manhattan;
  return AngleBetween_rad(NamedNearest(second.cam_from_manhattan, predicted), predicted);
}

}  // namespace

void Initializer::TakeAsReference(const Frame& frame) {
  frames_tried_ = 0;
  reference_.reset();
  if (frame.seen->num_features() < options_.min_features) return;
  reference_ = frame;
  predicted_px_.clear();
  for (const Keypoint& k : frame.seen->features.keypoints)
    predicted_px_.emplace_back(k.x_px, k.y_px);
}

std::optional<InitialMap> Initializer::Add(const Frame& frame, std::mt19937_64& rng) {
  if (!reference_ || frame.seen->num_features() < options_.min_features) {
    TakeAsReference(frame);
    return std::nullopt;
  }
  const Features& features = frame.seen->features;
  const Features& reference_features = reference_->seen->features;
  std::vector<Match> matches =
      MatchForInitialisation(reference_features, features, frame.seen->grid, predicted_px_);
  for (const Match& m : matches) {
    const Keypoint& k = features.keypoints[m.second];
    predicted_px_[m.first] = {k.x_px, k.y_px};
  }
  if (static_cast<int>(matches.size()) < options_.min_matches ||
      ++frames_tried_ > options_.max_frames) {
    TakeAsReference(frame);
    return std::nullopt;
  }
  std::vector<TwoViewMatch> pairs;
  for (const Match& m : matches) {
    const Keypoint& a = reference_features.keypoints[m.first];
    const Keypoint& b = features.keypoints[m.second];
    pairs.push_back(
        {a.Position(), b.Position(), scales_->scale(a.octave), scales_->scale(b.octave)});
  }
  const std::vector<bool> resting = RestingMatches(pairs, options_.resting);
  Remove(resting, &matches);
  Remove(resting, &pairs);
  const TwoViewResult result = EstimateTwoView(*camera_, pairs, options_.two_view, rng);
  const TwoViewCandidate* motion = Decide(result, frame.seen->lines.get());
  if (!motion) return std::nullopt;
  return MakeInitialMap(*reference_, matches, *motion);
}

const TwoViewCandidate* Initializer::Decide(const TwoViewResult& result,
                                            const LineSet* lines) const {
  if (result.status == TwoViewStatus::kOk) return &result.candidates.front();
  // Of several rivals one alone is left where the others lacked parallax. One of those may be the
  // true motion, so the one that is left is not taken.
  if (result.status != TwoViewStatus::kAmbiguous || result.candidates.size() < 2) return nullptr;
  const LineSet* reference_lines = reference_->seen->lines.get();
  const auto is_sound = [](const LineSet* set) {
    return set && IsSoundManhattan(*set, kMinSupport, kMaxSigma_rad);
  };
  if (!options_.vps || !is_sound(reference_lines) || !is_sound(lines)) return nullptr;
  // The only candidate that agrees with the vanishing points of both views.
  const TwoViewCandidate* agreeing = nullptr;
  for (const TwoViewCandidate& candidate : result.candidates) {
    const double difference_rad =
        VpDifference_rad(candidate.second_from_first.rotation, *reference_lines, *lines);
    if (difference_rad > options_.max_vp_difference_deg * kRadPerDeg) continue;
    if (agreeing) return nullptr;
    agreeing = &candidate;
  }
  return agreeing;
}

}  // namespace vpslam
