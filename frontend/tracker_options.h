// Settings of the frontend; read from the `frontend` section of a system configuration file.
#pragma once

#include <optional>
#include <string>

#include "core/estimation/pose_optimizer.h"
#include "core/features/orb_extractor.h"
#include "core/geometry/resting_matches.h"
#include "core/geometry/two_view.h"
#include "core/map/place_index.h"

namespace vpslam {

/// The first map, from two views.
struct InitializerOptions {
  int min_features = 100;  ///< an image with fewer cannot be one of the two views
  int min_matches = 50;    ///< with fewer, the reference view is given up for the present one
  int max_frames = 60;     ///< ... and also after as many frames without success
  TwoViewOptions two_view;
  RestingMatchesOptions resting;  ///< what is fixed to the camera has no say
  /// Where both views show the Manhattan axes well, their rotation decides between motions that the
  /// matches leave open: the only one that agrees with it to so much starts the map. Against a
  /// clear motion they have no say: see docs/method.md, "How a map starts".
  bool vps = true;
  double max_vp_difference_deg = 3.0;

  template <class V>
  void Visit(V& v) {
    v("min_features", min_features);
    v("min_matches", min_matches);
    v("max_frames", max_frames);
    v("two_view", two_view);
    v("resting", resting);
    v("vps", vps);
    v("max_vp_difference_deg", max_vp_difference_deg);
  }
};

/// Search for what the last frame saw.
struct MotionTrackingOptions {
  double window_px = 15;   ///< x scale of the octave; doubled when too little is found
  int min_matches = 20;    ///< fewer: double the window
  int max_distance = 100;  ///< Hamming
  int min_inliers = 10;    ///< fewer: the motion model has failed

  template <class V>
  void Visit(V& v) {
    v("window_px", window_px);
    v("min_matches", min_matches);
    v("max_distance", max_distance);
    v("min_inliers", min_inliers);
  }
};

/// Search for the rest of the local map.
struct LocalMapOptions {
  int max_keyframes = 80;
  int neighbours = 10;     ///< of each keyframe that sees the same points
  int max_distance = 100;  ///< Hamming
  double ratio = 0.8;
  double radius_px = 4.0;          ///< x scale of the octave
  double radius_frontal_px = 2.5;  ///< when seen from nearly the mean viewing direction
  int min_inliers = 40;            ///< fewer: the frame is lost
  int min_inliers_after_loss = 50;

  template <class V>
  void Visit(V& v) {
    v("max_keyframes", max_keyframes);
    v("neighbours", neighbours);
    v("max_distance", max_distance);
    v("ratio", ratio);
    v("radius_px", radius_px);
    v("radius_frontal_px", radius_frontal_px);
    v("min_inliers", min_inliers);
    v("min_inliers_after_loss", min_inliers_after_loss);
  }
};

/// Search for map lines.
struct LineTrackingOptions {
  bool enabled = true;       ///< needs detectors
  double window_px = 6;      ///< between a segment and where its line is predicted
  int max_distance = 70;     ///< Hamming
  double min_overlap = 0.3;  ///< of the shorter of segment and prediction

  template <class V>
  void Visit(V& v) {
    v("enabled", enabled);
    v("window_px", window_px);
    v("max_distance", max_distance);
    v("min_overlap", min_overlap);
  }
};

/// What is done with vanishing points in tracking.
enum class RotationMode {
  kOff,
  kPaper,  ///< overwrites the rotation (sec. III-B)
  kFused,  ///< a factor of the pose, with its covariance
};
/// What is done about the translation when the rotation is known.
enum class TranslationMode {
  kOff,
  kPaper,     ///< eq. 12
  kWeighted,  ///< its rows by the inverse of depth and sigma
};

struct VpRotationOptions {
  RotationMode mode = RotationMode::kFused;
  int min_cluster_lines = 5;        ///< kPaper: that eq. 2 asks for ("enough lines")
  int min_support = 3;              ///< kFused: lines that each of two axes needs
  double max_sigma_deg = 1.0;       ///< of the measured rotation about its worst direction
  double extra_sigma_deg = 0.3;     ///< on top of what the detector says
  double max_innovation_deg = 8.0;  ///< between measurement and pose: beyond it is not used

  template <class V>
  void Visit(V& v) {
    v("mode", mode);
    v("min_cluster_lines", min_cluster_lines);
    v("min_support", min_support);
    v("max_sigma_deg", max_sigma_deg);
    v("extra_sigma_deg", extra_sigma_deg);
    v("max_innovation_deg", max_innovation_deg);
  }
};

/// What to do when the camera is lost.
struct RelocalizerOptions {
  PlaceIndexOptions places;
  int max_candidates = 3;  ///< places that are tried, those with most votes first
  int neighbours = 5;      ///< keyframes taken together with the one that was named
  int min_matches = 15;    ///< between frame and place
  /// Inliers, as a share of the points that the pose found makes visible. A place that only looks
  /// like another one, a door like the next door, shows few of them: mostly below 0.12 in a
  /// corridor, where true returns in four sequences show 0.15 and more.
  double min_found_share = 0.12;
  /// The same where the camera can't have come in the time since it was seen
  /// (relocalization_gate.h).
  double min_found_share_far = 0.2;
  /// Frames that the camera is lost before a new map is begun; the old one stays.
  int frames_to_new_map = 30;

  template <class V>
  void Visit(V& v) {
    v("places", places);
    v("max_candidates", max_candidates);
    v("neighbours", neighbours);
    v("min_matches", min_matches);
    v("min_found_share", min_found_share);
    v("min_found_share_far", min_found_share_far);
    v("frames_to_new_map", frames_to_new_map);
  }
};

/// Search for other maps in what is tracked in one.
struct SeamOptions {
  int interval_frames = 5;              ///< between two searches
  int interval_after_seam_frames = 15;  ///< the backend may find it unfit
  int min_common = 20;                  ///< features that show points of both maps

  template <class V>
  void Visit(V& v) {
    v("interval_frames", interval_frames);
    v("interval_after_seam_frames", interval_after_seam_frames);
    v("min_common", min_common);
  }
};

/// When a frame becomes a keyframe. Counts frames, never time, so that all paces behave alike.
struct KeyframePolicyOptions {
  /// Of the reference keyframe's points and lines that have three observations or more (in a map of
  /// two keyframes, two): a frame that shows fewer becomes a keyframe.
  double max_tracked_ratio = 0.95;
  int min_frames = 1;  ///< since the last keyframe
  int min_inliers = 15;
  /// Where the backend works beside the tracker: with as many keyframes under work, further ones
  /// are left out. With tracking weak, up to max_unanswered_when_weak may be.
  int max_unanswered = 1;
  int max_unanswered_when_weak = 2;
  double weak_tracked_ratio = 0.5;  ///< of the same points and lines ...
  int weak_support = 120;           ///< ... or points and lines in all

  template <class V>
  void Visit(V& v) {
    v("max_tracked_ratio", max_tracked_ratio);
    v("min_frames", min_frames);
    v("min_inliers", min_inliers);
    v("max_unanswered", max_unanswered);
    v("max_unanswered_when_weak", max_unanswered_when_weak);
    v("weak_tracked_ratio", weak_tracked_ratio);
    v("weak_support", weak_support);
  }
};

struct TrackerOptions {
  OrbOptions orb;
  int num_features_to_start = 2000;  ///< per image, while there is no map
  InitializerOptions initializer;
  MotionTrackingOptions motion;
  LocalMapOptions local_map;
  LineTrackingOptions lines;
  VpRotationOptions rotation;
  TranslationMode translation = TranslationMode::kOff;
  KeyframePolicyOptions keyframes;
  RelocalizerOptions relocalizer;
  SeamOptions seams;
  PoseOptimizerOptions pose;
  /// A map that is lost before it has as many keyframes was started wrongly, and is given up.
  int probation_keyframes = 6;
  /// Frames kept, as features, to be placed in the map later.
  int max_buffered_frames = 300;
  int late_frames_per_frame = 2;  ///< how many of these are worked on after each new frame
  /// Late frames that see little of the map, or tie two maps together, become keyframes, but only
  /// one in so many of them: neighbours show too little parallax.
  int late_frames_per_keyframe = 3;

  template <class V>
  void Visit(V& v) {
    v("orb", orb);
    v("num_features_to_start", num_features_to_start);
    v("initializer", initializer);
    v("motion", motion);
    v("local_map", local_map);
    v("lines", lines);
    v("rotation", rotation);
    v("translation", translation);
    v("keyframes", keyframes);
    v("relocalizer", relocalizer);
    v("seams", seams);
    v("pose", pose);
    v("probation_keyframes", probation_keyframes);
    v("max_buffered_frames", max_buffered_frames);
    v("late_frames_per_frame", late_frames_per_frame);
    v("late_frames_per_keyframe", late_frames_per_keyframe);
  }
  std::optional<std::string> Validate() const;
};

}  // namespace vpslam
