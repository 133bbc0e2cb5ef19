#include "core/geometry/two_view.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/geometry/chi_square.h"
#include "core/geometry/essential.h"
#include "core/geometry/homography.h"
#include "core/geometry/motion_refinement.h"
#include "core/geometry/random_sample.h"
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

/// At most `count` of the matches, at random.
std::vector<RayMatch> Sample(std::vector<RayMatch> matches, int count, std::mt19937_64& rng) {
  const int size = static_cast<int>(matches.size());
  if (size <= count) return matches;
  for (int i = 0; i < count; ++i) std::swap(matches[i], matches[i + RandomIndex(size - i, rng)]);
  matches.resize(count);
  return matches;
}

/// Everything that follows from the motion.
void Reconstruct(std::span<const RayMatch> matches, const TwoViewOptions& options,
                 TwoViewCandidate* candidate) {
  const SE3& motion = candidate->second_from_first;
  const Eigen::Matrix3d essential = EssentialFromMotion(motion);
  const Eigen::Matrix3d rotation = motion.RotationMatrix();
  candidate->num_inliers = 0;
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

/// The matches' real noise over the given one, from those that obey the epipolar constraint;
/// between `min_scale` and 1.
double NoiseScale(std::span<const RayMatch> matches, const Eigen::Matrix3d& essential,
                  double min_scale) {
  std::vector<double> chi2s;
  for (const RayMatch& match : matches) {
    const double chi2 = SampsonChi2(essential, match);
    if (chi2 < kChi2Dof1) chi2s.push_back(chi2);
  }
  if (chi2s.empty()) return 1;
  const auto middle = chi2s.begin() + chi2s.size() / 2;
  std::nth_element(chi2s.begin(), middle, chi2s.end());
  // Median of chi-square with one degree of freedom, as far as it is below 3.841.
  constexpr double kMedianChi2 = 0.404;
  return std::clamp(std::sqrt(*middle / kMedianChi2), min_scale, 1.0);
}

/// What `num_points` points have to be seen under.
double NeededParallax_rad(int num_points, const TwoViewOptions& options) {
  const double scarcity = options.points_for_min_parallax / std::max(1.0, 1.0 * num_points);
  return options.min_parallax_rad * std::sqrt(std::max(1.0, scarcity));
}

/// Whether a and b differ by no more than what the matches leave open.
bool SameMotion(const TwoViewCandidate& a, const TwoViewCandidate& b) {
  // Rival interpretations of a scene are mostly tens of degrees apart.
  constexpr double kSameRotation_rad = 0.03, kSameDirection_rad = 0.05, kSigmas = 4;
  const Eigen::Vector3d &ta = a.second_from_first.translation,
                        &tb = b.second_from_first.translation;
  const double direction_rad = std::atan2(ta.cross(tb).norm(), ta.dot(tb));
  const double sigma_rad = std::max(a.direction_sigma_rad, b.direction_sigma_rad);
  return AngleBetween_rad(a.second_from_first.rotation, b.second_from_first.rotation) <
             kSameRotation_rad &&
         direction_rad < std::max(kSameDirection_rad, std::min(kSigmas * sigma_rad, 0.5));
}

/// The motions between which the matches cannot decide, refined; best first.
std::vector<TwoViewCandidate> Compete(std::span<const RayMatch> matches,
                                      std::vector<TwoViewCandidate> candidates, TwoViewModel model,
                                      const TwoViewOptions& options) {
  const auto keep_those_with_inliers = [&candidates](double share) {
    int most = 0;
    for (const TwoViewCandidate& c : candidates) most = std::max(most, c.num_inliers);
    std::erase_if(candidates, [&](const TwoViewCandidate& c) {
      return c.num_inliers == 0 || c.num_inliers < share * most;
    });
  };
  for (TwoViewCandidate& c : candidates) Reconstruct(matches, options, &c);
  // Half of what it takes to stay: refinement may bring some more.
  keep_those_with_inliers(0.5 * options.min_rival_inliers);
  for (TwoViewCandidate& c : candidates) {
    TwoViewCandidate refined = c;
    const MotionRefinement refinement =
        RefineMotionFromAfar(matches, 15, &refined.second_from_first);
    c.cost = refined.cost = refinement.cost;
    c.direction_sigma_rad = refined.direction_sigma_rad = refinement.direction_sigma_rad;
    // A plane constrains the motion better than the epipolar errors do alone; but it has to be one.
    const bool constrained =
        model == TwoViewModel::kHomography && c.proposed_by == TwoViewModel::kHomography;
    if (!constrained || !SameMotion(c, refined)) c = refined;
    Reconstruct(matches, options, &c);
  }
  keep_those_with_inliers(options.min_rival_inliers);
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.cost < b.cost; });
  std::vector<TwoViewCandidate> alive;
  for (TwoViewCandidate& c : candidates) {
    // Two motions that both explain n matches measure different components of the same noise, so
    // that their sums of n chi-squares differ by 2 sqrt(n) (one sigma) for no reason.
    if (!alive.empty() && c.cost > alive.front().cost + options.max_rival_sigmas * 2 *
                                                            std::sqrt(alive.front().num_inliers)) {
      break;
    }
    const auto known = std::find_if(alive.begin(), alive.end(),
                                    [&](const auto& other) { return SameMotion(other, c); });
    if (known == alive.end()) {
      alive.push_back(std::move(c));
    } else if (c.proposed_by == TwoViewModel::kHomography &&
               known->proposed_by == TwoViewModel::kEssential) {
      *known = std::move(c);  // the better estimate of the two, if of a slightly higher cost
    }
  }
  return alive;
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
  if (max_sampled_matches < min_matches) return "max_sampled_matches must reach min_matches";
  if (min_points < 1) return "min_points must be positive";
  if (!(min_parallax_rad > 0 && min_point_parallax_rad > 0)) return "parallaxes must be positive";
  if (points_for_min_parallax < 0) return "points_for_min_parallax must not be negative";
  if (!(min_displacement >= 0)) return "min_displacement must not be negative";
  if (!(max_direction_sigma_rad > 0)) return "max_direction_sigma_rad must be positive";
  if (!(min_noise_scale > 0 && min_noise_scale <= 1)) return "min_noise_scale must lie in 0 to 1";
  if (!(max_rival_sigmas >= 0)) return "max_rival_sigmas must not be negative";
  for (const double share :
       {max_rotation_share, min_rival_inliers, homography_share, near_plane_share}) {
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
  const std::vector<RayMatch> sampled = Sample(rays, options.max_sampled_matches, rng);
  result.rotation_share = EstimateRotation(sampled, options.ransac, rng).num_inliers /
                          static_cast<double>(sampled.size());
  if (result.rotation_share >= options.max_rotation_share) return result;

  const double num_matches = static_cast<double>(rays.size());
  const EssentialEstimate essential = EstimateEssential(sampled, options.ransac, rng);
  if (essential.score == 0) {
    result.status = TwoViewStatus::kTooFewPoints;
    return result;
  }
  const Eigen::Matrix3d essential_matrix = EssentialFromMotion(essential.motion);
  // The given sigmas set the gates. What decides between models must know the noise as it is.
  std::vector<RayMatch> scaled = rays;
  const double noise_scale = NoiseScale(rays, essential_matrix, options.min_noise_scale);
  for (RayMatch& match : scaled) {
    match.first_variance *= noise_scale * noise_scale;
    match.second_variance *= noise_scale * noise_scale;
  }
  HomographyEstimate homography =
      EstimateHomography(Sample(scaled, options.max_sampled_matches, rng), options.ransac, rng);
  RefineHomography(scaled, 10, kChi2Dof2, &homography.homography);
  result.noise_scale = noise_scale;
  result.essential_score = EssentialScore(essential_matrix, scaled);
  result.homography_score = HomographyScore(homography.homography, scaled);
  const double share = result.homography_score / (result.homography_score + result.essential_score);
  if (share > options.homography_share) result.model = TwoViewModel::kHomography;
  std::vector<TwoViewCandidate> proposals;
  const auto propose = [&](const SE3& motion, TwoViewModel model) {
    TwoViewCandidate proposal;
    proposal.second_from_first = motion;
    proposal.proposed_by = model;
    proposals.push_back(std::move(proposal));
  };
  if (share > options.near_plane_share) {
    for (const SE3& motion : DecomposeHomography(homography.homography)) {
      propose(motion, TwoViewModel::kHomography);
    }
  }
  for (const SE3& motion : DecomposeEssential(essential_matrix)) {
    propose(motion, TwoViewModel::kEssential);
  }
  std::vector<TwoViewCandidate> alive =
      Compete(scaled, std::move(proposals), result.model, options);
  for (TwoViewCandidate& candidate : alive) Reconstruct(rays, options, &candidate);

  result.status = TwoViewStatus::kTooFewPoints;
  if (alive.empty() || alive.front().num_inliers < options.min_points) return result;
  result.status = TwoViewStatus::kTooLittleParallax;
  if (result.rotation_share * num_matches >= options.max_rotation_share * alive.front().num_inliers)
    return result;
  const bool ambiguous = alive.size() > 1;
  bool parallax_lacks = false;
  std::erase_if(alive, [&](const TwoViewCandidate& c) {
    const bool enough = c.supported_parallax_rad >= NeededParallax_rad(c.num_points, options) &&
                        c.direction_sigma_rad <= options.max_direction_sigma_rad;
    parallax_lacks |= !enough;
    return !enough || c.num_points < options.min_points;
  });
  if (alive.empty()) {
    if (!parallax_lacks) result.status = TwoViewStatus::kTooFewPoints;
    return result;
  }
  result.status = ambiguous ? TwoViewStatus::kAmbiguous : TwoViewStatus::kOk;
  result.candidates = std::move(alive);
  return result;
}

}  // namespace vpslam
