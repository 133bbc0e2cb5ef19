#include "core/geometry/two_view.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/geometry/essential.h"
#include "core/geometry/homography.h"
#include "core/geometry/motion_refinement.h"
#include "core/geometry/rotation_only.h"
#include "core/geometry/triangulation.h"

namespace vpslam {
namespace {

bool IsUsable(const TwoViewMatch& match) {
  return match.first_px.allFinite() && match.second_px.allFinite() &&
         std::isfinite(match.first_sigma_px) && std::isfinite(match.second_sigma_px) &&
         match.first_sigma_px > 0 && match.second_sigma_px > 0;
}

double MedianDisplacement(std::span<const RayMatch> matches) {
  std::vector<double> displacement;
  displacement.reserve(matches.size());
  for (const RayMatch& match : matches) {
    displacement.push_back((match.second - match.first).norm());
  }
  const auto middle = displacement.begin() + displacement.size() / 2;
  std::nth_element(displacement.begin(), middle, displacement.end());
  return *middle;
}

int CountPoints(std::span<const RayMatch> matches, const SE3& motion,
                const TwoViewOptions& options) {
  const Eigen::Matrix3d essential = EssentialFromMotion(motion);
  int count = 0;
  for (const RayMatch& match : matches) {
    double parallax_rad;
    count += SampsonChi2(essential, match) < kChi2Dof1 &&
             TriangulateTwoView(motion, match, &parallax_rad) &&
             parallax_rad >= options.min_point_parallax_rad;
  }
  return count;
}

/// Everything that follows from the motion.
void Reconstruct(std::span<const RayMatch> matches, const TwoViewOptions& options,
                 TwoViewCandidate* candidate) {
  const SE3& motion = candidate->second_from_first;
  const Eigen::Matrix3d essential = EssentialFromMotion(motion);
  const Eigen::Matrix3d rotation = motion.RotationMatrix();
  candidate->inlier.assign(matches.size(), false);
  candidate->point.assign(matches.size(), std::nullopt);
  std::vector<double> parallaxes_rad;
  for (size_t i = 0; i < matches.size(); ++i) {
    if (!(SampsonChi2(essential, matches[i]) < kChi2Dof1)) continue;
    double parallax_rad = 0;
    const std::optional<Eigen::Vector3d> point =
        TriangulateTwoView(motion, matches[i], &parallax_rad);
    // A point so far away that noise alone may have put it behind the camera is no contradiction.
    candidate->inlier[i] = point || TransferChi2(rotation, matches[i]) < kChi2Dof2;
    candidate->num_inliers += candidate->inlier[i];
    if (!point || parallax_rad < options.min_point_parallax_rad) continue;
    candidate->point[i] = point;
    parallaxes_rad.push_back(parallax_rad);
  }
  candidate->num_points = static_cast<int>(parallaxes_rad.size());
  if (parallaxes_rad.empty()) return;
  std::sort(parallaxes_rad.begin(), parallaxes_rad.end(), std::greater<>());
  candidate->median_parallax_rad = parallaxes_rad[parallaxes_rad.size() / 2];
  candidate->supported_parallax_rad =
      parallaxes_rad[std::min<size_t>(options.min_points, parallaxes_rad.size()) - 1];
}

bool SameMotion(const SE3& a, const SE3& b) {
  // Different minima are degrees apart; two ways to the same one end much closer.
  constexpr double kSameRotation_rad = 1e-3, kSameDirection = 1e-2;
  return AngleBetween_rad(a.rotation, b.rotation) < kSameRotation_rad &&
         (a.translation - b.translation).norm() < kSameDirection;
}

/// Refined motions that are alive as far as the number of their points goes, best first.
std::vector<TwoViewCandidate> Compete(std::span<const RayMatch> matches,
                                      const std::vector<TwoViewCandidate>& proposals,
                                      const TwoViewOptions& options) {
  std::vector<int> counts;
  int most = 0;
  for (const TwoViewCandidate& proposal : proposals) {
    counts.push_back(CountPoints(matches, proposal.second_from_first, options));
    most = std::max(most, counts.back());
  }
  std::vector<TwoViewCandidate> refined;
  for (size_t i = 0; i < proposals.size(); ++i) {
    // Half of what it takes to be alive: refinement may bring some more.
    if (counts[i] == 0 || counts[i] < 0.5 * options.min_rival_points * most) continue;
    TwoViewCandidate candidate = proposals[i];
    MotionRefinementOptions refinement;
    refinement.max_chi2 = kChi2Dof1;
    const MotionRefinement result = RefineMotion(matches, refinement, &candidate.second_from_first);
    const bool known = std::any_of(refined.begin(), refined.end(), [&](const auto& other) {
      return SameMotion(other.second_from_first, candidate.second_from_first);
    });
    if (known) continue;
    candidate.cost = result.cost;
    candidate.direction_sigma_rad = result.direction_sigma_rad;
    Reconstruct(matches, options, &candidate);
    refined.push_back(std::move(candidate));
  }
  most = 0;
  for (const TwoViewCandidate& candidate : refined) most = std::max(most, candidate.num_points);
  std::erase_if(refined, [&](const TwoViewCandidate& candidate) {
    return candidate.num_points < options.min_rival_points * most;
  });
  std::stable_sort(refined.begin(), refined.end(),
                   [](const auto& a, const auto& b) { return a.cost < b.cost; });
  return refined;
}

}  // namespace

const char* ToString(TwoViewStatus status) {
  switch (status) {
    case TwoViewStatus::kOk:
      return "ok";
    case TwoViewStatus::kInvalidInput:
      return "invalid input";
    case TwoViewStatus::kTooFewMatches:
      return "too few matches";
    case TwoViewStatus::kTooLittleParallax:
      return "too little parallax";
    case TwoViewStatus::kTooFewPoints:
      return "too few points";
    case TwoViewStatus::kAmbiguous:
      return "ambiguous";
  }
  return "unknown";
}

std::optional<std::string> TwoViewOptions::Validate() const {
  if (min_matches < 5) return "min_matches must be at least 5";
  if (min_points < 1) return "min_points must be positive";
  if (!(min_parallax_rad > 0 && min_point_parallax_rad > 0)) return "parallaxes must be positive";
  if (!(min_displacement >= 0)) return "min_displacement must not be negative";
  if (!(max_direction_sigma_rad > 0)) return "max_direction_sigma_rad must be positive";
  if (!(max_rival_cost >= 0)) return "max_rival_cost must not be negative";
  for (const double share : {max_rotation_share, min_rival_points, homography_share}) {
    if (!(share > 0 && share <= 1)) return "shares must lie in 0 to 1";
  }
  return ransac.Validate();
}

TwoViewResult EstimateTwoView(const Camera& camera, std::span<const TwoViewMatch> matches,
                              const TwoViewOptions& options, std::mt19937_64& rng) {
  TwoViewResult result;
  if (!std::all_of(matches.begin(), matches.end(), IsUsable)) {
    result.status = TwoViewStatus::kInvalidInput;
    return result;
  }
  if (static_cast<int>(matches.size()) < options.min_matches) return result;
  std::vector<RayMatch> rays;
  rays.reserve(matches.size());
  for (const TwoViewMatch& m : matches) {
    rays.push_back(
        MakeRayMatch(camera, m.first_px, m.second_px, m.first_sigma_px, m.second_sigma_px));
  }

  // What costs little first: most calls come from frames too close to each other.
  result.status = TwoViewStatus::kTooLittleParallax;
  if (MedianDisplacement(rays) < options.min_displacement) return result;
  const int rotation_inliers = EstimateRotation(rays, options.ransac, rng).num_inliers;
  const double num_matches = static_cast<double>(rays.size());
  result.rotation_share = rotation_inliers / num_matches;
  if (result.rotation_share >= options.max_rotation_share) return result;

  const EssentialEstimate essential = EstimateEssential(rays, options.ransac, rng);
  const HomographyEstimate homography = EstimateHomography(rays, options.ransac, rng);
  result.essential_score = essential.score;
  result.homography_score = homography.score;
  if (homography.score > options.homography_share * (homography.score + essential.score)) {
    result.model = TwoViewModel::kHomography;
  }
  std::vector<TwoViewCandidate> proposals;
  const auto propose = [&proposals](const SE3& motion, TwoViewModel model) {
    TwoViewCandidate proposal;
    proposal.second_from_first = motion;
    proposal.proposed_by = model;
    proposals.push_back(std::move(proposal));
  };
  if (essential.score > 0) {
    for (const SE3& motion : DecomposeEssential(EssentialFromMotion(essential.motion))) {
      propose(motion, TwoViewModel::kEssential);
    }
  }
  if (homography.score > 0) {
    for (const SE3& motion : DecomposeHomography(homography.homography)) {
      propose(motion, TwoViewModel::kHomography);
    }
  }
  std::vector<TwoViewCandidate> candidates = Compete(rays, proposals, options);

  result.status = TwoViewStatus::kTooFewPoints;
  if (candidates.empty()) return result;
  const TwoViewCandidate& best = candidates.front();
  const bool rotation_explains = rotation_inliers >= options.max_rotation_share * best.num_inliers;
  if (best.num_inliers >= options.min_points &&
      (rotation_explains || best.supported_parallax_rad < options.min_parallax_rad ||
       !(best.direction_sigma_rad <= options.max_direction_sigma_rad))) {
    result.status = TwoViewStatus::kTooLittleParallax;
    return result;
  }
  if (best.num_points < options.min_points) return result;
  const double max_cost = (1 + options.max_rival_cost) * best.cost;
  std::erase_if(candidates, [&](const TwoViewCandidate& candidate) {
    return candidate.cost > max_cost || candidate.num_points < options.min_points ||
           candidate.supported_parallax_rad < options.min_parallax_rad;
  });
  result.status = candidates.size() > 1 ? TwoViewStatus::kAmbiguous : TwoViewStatus::kOk;
  result.candidates = std::move(candidates);
  return result;
}

}  // namespace vpslam
