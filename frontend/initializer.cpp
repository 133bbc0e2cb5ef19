#include "frontend/initializer.h"

#include <algorithm>

#include "core/features/matcher.h"

namespace vpslam {
namespace {

InitialMap MakeInitialMap(const Frame& first, const Frame& second,
                          const std::vector<Match>& matches, const TwoViewCandidate& motion) {
  InitialMap map{first, second, {}};
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
  map.first.cam_from_world = SE3();
  map.second.cam_from_world =
      SE3(motion.second_from_first.rotation, motion.second_from_first.translation * scale);
  return map;
}

}  // namespace

void Initializer::TakeAsReference(const Frame& frame) {
  frames_tried_ = 0;
  reference_.reset();
  if (frame.features.size() < options_.min_features) return;
  reference_ = frame;
  predicted_px_.clear();
  for (const Keypoint& k : frame.features.keypoints) predicted_px_.emplace_back(k.x_px, k.y_px);
}

std::optional<InitialMap> Initializer::Add(const Frame& frame, std::mt19937_64& rng) {
  if (!reference_ || frame.features.size() < options_.min_features) {
    TakeAsReference(frame);
    return std::nullopt;
  }
  const std::vector<Match> matches =
      MatchForInitialisation(reference_->features, frame.features, frame.grid, predicted_px_);
  for (const Match& m : matches) {
    const Keypoint& k = frame.features.keypoints[m.second];
    predicted_px_[m.first] = {k.x_px, k.y_px};
  }
  if (static_cast<int>(matches.size()) < options_.min_matches ||
      ++frames_tried_ > options_.max_frames) {
    TakeAsReference(frame);
    return std::nullopt;
  }
  std::vector<TwoViewMatch> pairs;
  for (const Match& m : matches) {
    const Keypoint& a = reference_->features.keypoints[m.first];
    const Keypoint& b = frame.features.keypoints[m.second];
    pairs.push_back({a.Position(), b.Position(), scales_.scale(a.octave), scales_.scale(b.octave)});
  }
  const TwoViewResult result = EstimateTwoView(camera_, pairs, options_.two_view, rng);
  if (result.status != TwoViewStatus::kOk) return std::nullopt;
  return MakeInitialMap(*reference_, frame, matches, result.candidates.front());
}

}  // namespace vpslam
