// Motion and structure from two views of a calibrated camera: how a monocular map starts.
//
// Proposes motions from an essential matrix and from a homography, refines each on all matches, and
// lets the matches decide between them; says no, and why, where they cannot. [Mur15] ("ORB-SLAM: a
// versatile and accurate monocular SLAM system", sec. IV) scores both models alike and picks one
// beforehand; the score is used here as well, but both propose and the refined motions compete on
// the same terms, so that a scene which is neither flat nor deep is not lost to the wrong choice.
#pragma once

#include <optional>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/geometry/camera.h"
#include "core/geometry/ransac.h"
#include "core/geometry/se3.h"

namespace vpslam {

/// Undistorted positions. One sigma per coordinate; for ORB it grows with the octave.
struct TwoViewMatch {
  Eigen::Vector2d first_px, second_px;
  double first_sigma_px = 1, second_sigma_px = 1;
};

enum class TwoViewStatus {
  kOk,
  kInvalidInput,       ///< a position is not finite, or a sigma is not positive
  kTooFewMatches,      ///< fewer than min_matches
  kTooLittleParallax,  ///< hardly any displacement, pure rotation, or a baseline too small
  kTooFewPoints,       ///< no motion explains enough matches by points in front of both cameras
  kAmbiguous,          ///< several motions explain the matches almost equally well
};

const char* ToString(TwoViewStatus status);

enum class TwoViewModel { kEssential, kHomography };

struct TwoViewOptions {
  int min_matches = 50;
  int min_points = 30;
  /// At least min_points points must be seen under this angle or more ...
  double min_parallax_rad = 0.0175;
  /// ... where there are this many. Fewer tell rotation and translation apart less well (the error
  /// goes with one over the root of their number), and the angle has to be larger by as much.
  int points_for_min_parallax = 800;
  /// Points with less parallax are no points, though their matches are inliers.
  double min_point_parallax_rad = 0.005;
  /// Median displacement, in units of the focal length, below which nothing is even tried.
  double min_displacement = 0.004;
  /// Pure rotation if it explains this share of the matches that the best motion explains.
  double max_rotation_share = 0.8;
  /// Standard deviation of the direction of translation beyond which it is not known.
  double max_direction_sigma_rad = 0.15;
  /// Real positions are often better than the given sigmas say (sub-pixel corners, blurred copies
  /// of one error in both images); models are compared at the noise found, but at no less than this
  /// times the sigmas.
  double min_noise_scale = 0.3;
  /// A motion is a rival of the best if it has this share of the most inliers of any ...
  double min_rival_inliers = 0.75;
  /// ... and its sum of truncated chi-squares exceeds the least by less than what is usual between
  /// two interpretations of one plane.
  double max_rival_sigmas = 3;
  /// [Mur15] sec. IV: the scene is taken for a plane if S_H / (S_H + S_E) exceeds this. With true
  /// variances a plane has 0.445, and 1.5 degrees of parallax in a deep scene have 0.3.
  double homography_share = 0.42;
  /// Beyond this share the scene is flat enough for a plane's second interpretation to be a rival,
  /// so that the homography proposes its motions as well.
  double near_plane_share = 0.35;
  /// RANSAC sees that many matches at most; the motions it finds are refined on all.
  int max_sampled_matches = 400;
  /// More samples than an all-inlier one needs: noise decides how good it is.
  RansacOptions ransac{.max_iterations = 300, .min_iterations = 50, .confidence = 0.99999};

  template <class V>
  void Visit(V& v) {
    v("min_matches", min_matches);
    v("min_points", min_points);
    v("min_parallax_rad", min_parallax_rad);
    v("points_for_min_parallax", points_for_min_parallax);
    v("min_point_parallax_rad", min_point_parallax_rad);
    v("min_displacement", min_displacement);
    v("max_rotation_share", max_rotation_share);
    v("max_direction_sigma_rad", max_direction_sigma_rad);
    v("min_noise_scale", min_noise_scale);
    v("min_rival_inliers", min_rival_inliers);
    v("max_rival_sigmas", max_rival_sigmas);
    v("homography_share", homography_share);
    v("near_plane_share", near_plane_share);
    v("max_sampled_matches", max_sampled_matches);
    v("ransac", ransac);
  }

  std::optional<std::string> Validate() const;
};

struct TwoViewCandidate {
  SE3 second_from_first;  ///< |t| = 1
  TwoViewModel proposed_by = TwoViewModel::kEssential;
  /// Per match: it obeys the epipolar constraint (95 %) and does not lie behind a camera.
  std::vector<bool> inlier;
  /// Per match: position in the first camera, in baselines, if it is an inlier with parallax.
  std::vector<std::optional<Eigen::Vector3d>> point;
  int num_inliers = 0;
  int num_points = 0;
  double median_parallax_rad = 0;  ///< of the points
  /// The min_points-th largest parallax; what min_parallax_rad is compared with.
  double supported_parallax_rad = 0;
  double direction_sigma_rad = 0;  ///< of the translation, to first order
  double cost = 0;                 ///< sum over all matches of min(chi2, 3.841)
};

struct TwoViewResult {
  TwoViewStatus status = TwoViewStatus::kTooFewMatches;
  /// Best first. Exactly one if kOk. If kAmbiguous those rivals that would have been accepted alone
  /// (typically both interpretations of a plane); one at least. Else none.
  std::vector<TwoViewCandidate> candidates;
  TwoViewModel model = TwoViewModel::kEssential;  ///< what describes the scene, by score
  double essential_score = 0;
  double homography_score = 0;
  double noise_scale = 1;     ///< noise found / given sigmas
  double rotation_share = 0;  ///< share of matches that pure rotation explains
};

/// The camera, and the options, have been validated by the caller. The same input and state of the
/// generator give the same result.
TwoViewResult EstimateTwoView(const Camera& camera, std::span<const TwoViewMatch> matches,
                              const TwoViewOptions& options, std::mt19937_64& rng);

}  // namespace vpslam
