// Settings of the backend; read from the `backend` section of a system configuration file.
#pragma once

#include <optional>
#include <string>

#include "core/features/orb_extractor.h"

namespace vpslam {

/// Local bundle adjustment.
struct LocalBaOptions {
  int max_keyframes = 20;       ///< whose poses are moved: the new one and those that share most
  int max_fixed_keyframes = 20; ///< others that see the same points: measured from, not moved
  int min_shared_points = 15;   ///< with the new keyframe, to be moved
  int max_iterations = 10;
  int max_iterations_to_start = 30;  ///< for the two views of a new map
};

/// New points.
struct PointCreatorOptions {
  int neighbours = 20;                    ///< keyframes to match with [Mur15: 20 for one camera]
  double min_baseline_per_depth = 0.01;   ///< of the neighbour's median depth
  double max_parallax_cosine = 0.9998;    ///< 1.15 degrees: less says nothing about depth
  double max_scale_mismatch = 1.8;        ///< ratio of distances against ratio of octaves
};

/// Duplicates.
struct PointFuserOptions {
  int neighbours = 20;
  int second_neighbours = 5;  ///< of each neighbour
  double radius_px = 3.0;     ///< x scale of the octave
  int max_distance = 50;      ///< Hamming
};

/// What is thrown away again.
struct CullingOptions {
  double min_found_ratio = 0.25;     ///< found / predicted visible, of a new point
  int probation_keyframes = 3;       ///< a point that as many keyframes later ...
  int min_observations = 3;          ///< ... has fewer observations goes
  double max_redundant_share = 0.9;  ///< of a keyframe's points seen by min_other_observers
  int min_other_observers = 3;       ///< at the same or a finer scale
};

struct MapperOptions {
  OrbOptions orb;  ///< as the frontend's: number and factor of the pyramid's levels
  LocalBaOptions ba;
  PointCreatorOptions creator;
  PointFuserOptions fuser;
  CullingOptions culling;

  std::optional<std::string> Validate() const;
};

}  // namespace vpslam
