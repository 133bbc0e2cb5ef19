// Matching of features by descriptor, guided by what is known about their positions.
//
// Pure functions: the result depends on the arguments alone, and ties go to the lower index.
// "Ratio": a match counts only if its distance is below ratio x that of the runner-up.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/features/feature_grid.h"
#include "core/features/features.h"
#include "core/features/rotation_consistency.h"
#include "core/features/scale_levels.h"
#include "core/geometry/camera.h"
#include "core/geometry/se3.h"

namespace vpslam {

/// Indices into the features of a first and a second image.
struct Match {
  int32_t first = -1;
  int32_t second = -1;
  bool operator==(const Match&) const = default;
};

/// Removes matches whose key points turned otherwise than most do.
void KeepRotationConsistent(const Features& first, const Features& second,
                            const RotationConsistencyOptions& options, std::vector<Match>* matches);

// ---- Two views that shall start a map ----

struct InitialisationMatchOptions {
  float window_px = 100;  ///< radius around the predicted position
  int max_distance = 50;  ///< Hamming
  float ratio = 0.9f;
  bool check_rotation = true;
  RotationConsistencyOptions rotation = {};
};

/// One-to-one, ordered by `first`, within one octave of each other. `predicted_px[i]` is where
/// first.keypoints[i] is expected in the second image (its own position, or where it was last
/// seen), undistorted px.
std::vector<Match> MatchForInitialisation(const Features& first, const Features& second,
                                          const FeatureGrid& second_grid,
                                          std::span<const Eigen::Vector2f> predicted_px,
                                          const InitialisationMatchOptions& options = {});

// ---- A map point that is expected at some place ----

struct WindowQuery {
  float x_px = 0, y_px = 0;  ///< expected position, undistorted
  float radius_px = 0;
  OctaveRange octaves = {};
  int max_distance = 100;  ///< Hamming
  /// Applied when best and runner-up have the same octave: a neighbouring octave often shows the
  /// same corner once more, which is no ambiguity. 1 or more: never.
  float ratio = 1.0f;
  /// If given, only candidates that pass the chi-square gate of their octave count: the best
  /// descriptor must not hide one that is where it should be.
  const ScalePyramid* accuracy = nullptr;
};

struct WindowMatch {
  int index = -1;
  int distance = 256;
  int second_distance = 256;  ///< of the runner-up; 256 if there is none
};

/// Best candidate, or nullopt if none is near enough or the ratio test fails. `taken[i]` != 0
/// excludes feature i; an empty span excludes none.
std::optional<WindowMatch> BestMatchInWindow(const Descriptor& descriptor, const WindowQuery& query,
                                             const Features& features, const FeatureGrid& grid,
                                             std::span<const uint8_t> taken = {});

// ---- Images whose relative pose is unknown ----

struct DescriptorMatchOptions {
  int max_distance = 50;  ///< Hamming
  float ratio = 0.75f;
};

/// Brute force: each other's best, ratio on the side of `first`. Ordered by `first`.
std::vector<Match> MatchByDescriptor(std::span<const Descriptor> first,
                                     std::span<const Descriptor> second,
                                     const DescriptorMatchOptions& options = {});

// ---- Keyframes with known poses, for new points ----

struct TriangulationMatchOptions {
  int max_distance = 50;  ///< Hamming
  float ratio = 0.8f;
  double epipolar_chi2 = 3.84;    ///< squared distance from the epipolar line / sigma2(octave)
  double min_epipole_px = 10;     ///< x scale(octave): nearer to the epipole, depth is undefined
  double same_corner_px = 3;      ///< x scale(octave): nearer to the best, a runner-up is no rival
  double min_depth = 0;           ///< in the first view; what implies less is no candidate
  double max_parallax_rad = 1.0;  ///< between the two rays: descriptors do not stand more
  bool check_rotation = true;
  RotationConsistencyOptions rotation = {};
};

/// Matches of the features listed in `first_free` with those in `second_free` (indices, ascending),
/// along epipolar lines; one-to-one, ordered by `first`. The translation of `second_from_first`
/// must not be 0 (then nothing matches).
std::vector<Match> MatchForTriangulation(const Features& first, std::span<const int32_t> first_free,
                                         const Features& second,
                                         std::span<const int32_t> second_free,
                                         const SE3& second_from_first, const Camera& camera,
                                         const ScalePyramid& scales,
                                         const TriangulationMatchOptions& options = {});

}  // namespace vpslam
