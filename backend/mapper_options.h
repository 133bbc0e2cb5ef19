// Settings of the backend; read from the `backend` section of a system configuration file.
#pragma once

#include <optional>
#include <string>

#include "core/features/orb_extractor.h"

namespace vpslam {

/// Local bundle adjustment.
struct LocalBaOptions {
  int max_keyframes = 20;        ///< whose poses are moved: the new one and those that share most
  int max_fixed_keyframes = 20;  ///< others that see the same points: measured from, not moved
  /// Where fewer others see them, the oldest keyframes of the window are held instead: one holds
  /// position and rotation of the map, two hold its scale as well.
  int min_fixed_keyframes = 2;
  /// Where keyframes show fewer points than plenty, there are more of them in either group: by that
  /// ratio to the power `growth_power`, but no more than `max_growth` times the numbers above.
  double plenty_points = 300;
  double growth_power = 2;
  double max_growth = 10;
  int min_shared_points = 15;  ///< with the new keyframe, to be moved
  int max_iterations = 10;
  int max_iterations_to_start = 30;       ///< for the two views of a new map
  int max_iterations_after_outliers = 0;  ///< again without them, and without a robust loss
  int min_iterations_when_urgent = 2;     ///< when the next keyframe waits already
  double function_tolerance = 1e-4;       ///< relative decrease of the cost that ends the iteration
  double direction_sigma_deg = 0.5;       ///< of a line about the Manhattan axis that it belongs to
  double min_line_depth_share = 0.2;      ///< see IsTooNear; less than that of new lines

  template <class V>
  void Visit(V& v) {
    v("max_keyframes", max_keyframes);
    v("max_fixed_keyframes", max_fixed_keyframes);
    v("min_fixed_keyframes", min_fixed_keyframes);
    v("plenty_points", plenty_points);
    v("growth_power", growth_power);
    v("max_growth", max_growth);
    v("min_shared_points", min_shared_points);
    v("max_iterations", max_iterations);
    v("max_iterations_to_start", max_iterations_to_start);
    v("max_iterations_after_outliers", max_iterations_after_outliers);
    v("min_iterations_when_urgent", min_iterations_when_urgent);
    v("function_tolerance", function_tolerance);
    v("direction_sigma_deg", direction_sigma_deg);
    v("min_line_depth_share", min_line_depth_share);
  }
};

/// New points.
struct PointCreatorOptions {
  int neighbours = 20;                   ///< keyframes to match with [Mur15: 20 for one camera]
  double min_baseline_per_depth = 0.01;  ///< of the neighbour's median depth
  double max_parallax_cosine = 0.9998;   ///< 1.15 degrees: less says nothing about depth
  double max_parallax_rad = 0.5;         ///< between the rays: descriptors do not stand more
  double max_scale_mismatch = 1.8;       ///< ratio of distances against ratio of octaves
  int max_distance = 60;                 ///< Hamming
  double ratio = 0.9;                    ///< of descriptor distances, best to best elsewhere
  double min_depth_share = 0.3;          ///< of the depth that 95 % of the points exceed

  template <class V>
  void Visit(V& v) {
    v("neighbours", neighbours);
    v("min_baseline_per_depth", min_baseline_per_depth);
    v("max_parallax_cosine", max_parallax_cosine);
    v("max_parallax_rad", max_parallax_rad);
    v("max_scale_mismatch", max_scale_mismatch);
    v("max_distance", max_distance);
    v("ratio", ratio);
    v("min_depth_share", min_depth_share);
  }
};

/// Duplicates.
struct PointFuserOptions {
  int neighbours = 20;
  int second_neighbours = 5;  ///< of each neighbour
  double radius_px = 3.0;     ///< x scale of the octave
  int max_distance = 70;      ///< Hamming

  template <class V>
  void Visit(V& v) {
    v("neighbours", neighbours);
    v("second_neighbours", second_neighbours);
    v("radius_px", radius_px);
    v("max_distance", max_distance);
  }
};

/// New lines, and duplicates.
struct LineMappingOptions {
  bool enabled = true;    ///< needs detectors
  int neighbours = 10;    ///< keyframes to match with
  int max_distance = 60;  ///< Hamming
  double ratio = 0.8;     ///< of descriptor distances, best to best elsewhere
  /// Between a ray of one view and the plane of the other: less says nothing about depth.
  double min_ray_plane_angle_deg = 1.5;
  double max_depth_ratio = 2.0;  ///< of the depth that 90 % of the points stay below
  double min_depth_share = 0.3;  ///< of the depth that 95 % of the points exceed, see IsTooNear
  int min_views_near = 5;        ///< that agree, of a line nearer than that depth
  double min_overlap = 0.5;      ///< of the shorter of two segments
  double max_offset_px = 4.0;    ///< between a segment and where a line is predicted
  int probation_keyframes = 3;   ///< as for points
  int min_observations = 3;

  template <class V>
  void Visit(V& v) {
    v("enabled", enabled);
    v("neighbours", neighbours);
    v("max_distance", max_distance);
    v("ratio", ratio);
    v("min_ray_plane_angle_deg", min_ray_plane_angle_deg);
    v("max_depth_ratio", max_depth_ratio);
    v("min_depth_share", min_depth_share);
    v("min_views_near", min_views_near);
    v("min_overlap", min_overlap);
    v("max_offset_px", max_offset_px);
    v("probation_keyframes", probation_keyframes);
    v("min_observations", min_observations);
  }
};

/// What is thrown away again.
struct CullingOptions {
  double min_found_ratio = 0.25;     ///< found / predicted visible, of a new point
  int probation_keyframes = 3;       ///< a point that in the last of these, its first counted, ...
  int min_observations = 3;          ///< ... has fewer observations goes
  double max_redundant_share = 0.9;  ///< of a keyframe's points seen by min_other_observers
  int min_other_observers = 3;       ///< at a finer scale, or at most one octave coarser
  /// A keyframe with fewer points needs more other observers of each, by the same ratio to the
  /// power `scarcity_power`: where there is little to see, accuracy comes from seeing it often.
  int plenty_points = 240;
  double scarcity_power = 10;
  double points_per_line = 4;  ///< that a line is worth

  template <class V>
  void Visit(V& v) {
    v("min_found_ratio", min_found_ratio);
    v("probation_keyframes", probation_keyframes);
    v("min_observations", min_observations);
    v("max_redundant_share", max_redundant_share);
    v("min_other_observers", min_other_observers);
    v("plenty_points", plenty_points);
    v("scarcity_power", scarcity_power);
    v("points_per_line", points_per_line);
  }
};

/// The Manhattan axes as seen by keyframes, and as a frame of the map.
struct ManhattanOptions {
  bool enabled = true;         ///< hold bundle adjustment to the frame; needs detectors
  int min_support = 3;         ///< distinct lines that at least two axes need
  double max_sigma_deg = 1.0;  ///< of the measured rotation about its worst direction
  /// Least of what comes on top of the measurement's own standard deviations: detectors are more
  /// certain than they are right, and err alike in images that are alike. How much that is, the map
  /// learns from how far measurements lie from its frame.
  double min_sigma_deg = 0.1;
  /// Between measurement and map: beyond it the measurement says nothing of where the frame is ...
  double max_innovation_deg = 3.0;
  /// ... but up to this it binds its keyframe: where hardly a feature was to be seen, the keyframe
  /// is more likely to have turned than the scene.
  double max_correction_deg = 8.0;
  /// The frame is born when as many keyframes in a row agree ...
  int keyframes_to_birth = 5;
  double max_birth_spread_deg = 1.5;  ///< ... each with their mean within this.
  /// Of the last `loss_window` measurements: the frame is forgotten when fewer than half bind ...
  int loss_window = 10;
  int keyframes_to_confirm = 20;  ///< ... unless as many keyframes belong to it: it is elsewhere

  template <class V>
  void Visit(V& v) {
    v("enabled", enabled);
    v("min_support", min_support);
    v("max_sigma_deg", max_sigma_deg);
    v("min_sigma_deg", min_sigma_deg);
    v("max_innovation_deg", max_innovation_deg);
    v("max_correction_deg", max_correction_deg);
    v("keyframes_to_birth", keyframes_to_birth);
    v("max_birth_spread_deg", max_birth_spread_deg);
    v("loss_window", loss_window);
    v("keyframes_to_confirm", keyframes_to_confirm);
  }
};

/// Two maps that turn out to show one place.
struct MergingOptions {
  int min_common_points = 20;   ///< that agree with the similarity between the maps
  double min_share = 0.5;       ///< ... of those that look alike
  double max_sigmas = 2;        ///< what the chi-square gate allows for: points err, too
  int max_keyframes = 40;       ///< that bundle adjustment across the seam moves
  int max_iterations = 20;      ///< of it
  int neighbours_to_fuse = 10;  ///< of the seam, whose points are looked for in one another

  template <class V>
  void Visit(V& v) {
    v("min_common_points", min_common_points);
    v("min_share", min_share);
    v("max_sigmas", max_sigmas);
    v("max_keyframes", max_keyframes);
    v("max_iterations", max_iterations);
    v("neighbours_to_fuse", neighbours_to_fuse);
  }
};

struct MapperOptions {
  OrbOptions orb;  ///< as the frontend's: number and factor of the pyramid's levels
  LocalBaOptions ba;
  PointCreatorOptions creator;
  PointFuserOptions fuser;
  LineMappingOptions lines;
  CullingOptions culling;
  ManhattanOptions manhattan;
  MergingOptions merging;

  template <class V>
  void Visit(V& v) {
    v("orb", orb);
    v("ba", ba);
    v("creator", creator);
    v("fuser", fuser);
    v("lines", lines);
    v("culling", culling);
    v("manhattan", manhattan);
    v("merging", merging);
  }
  std::optional<std::string> Validate() const;
};

}  // namespace vpslam
