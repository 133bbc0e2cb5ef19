// What the map does not need: points that are not found again, keyframes that tell nothing new.
#pragma once

#include <map>
#include <vector>

#include "backend/mapper_options.h"
#include "core/map/owned_map.h"
#include "core/messages/keyframe_proposal.h"

namespace vpslam {

/// New points on probation, by how often tracking expected and found them. [Mur15] sec. VI-B.
class PointProbation {
 public:
  explicit PointProbation(const CullingOptions& options) : options_(options) {}

  void Add(PointId point, int keyframe_count);
  void Count(const PointSighting& sighting);
  /// Erases the points that failed; forgets those that passed. `keyframe_count`: keyframes so far.
  void Cull(int keyframe_count, OwnedMap* map);

 private:
  struct Record {
    int created_at = 0;
    int visible = 1;  // the observation that created it
    int found = 1;
  };
  CullingOptions options_;
  std::map<PointId, Record> records_;
};

/// New lines on probation, by how many keyframes show them.
class LineProbation {
 public:
  explicit LineProbation(const LineMappingOptions& options) : options_(options) {}

  void Add(LineId line, int keyframe_count) { created_at_[line] = keyframe_count; }
  void Cull(int keyframe_count, OwnedMap* map);

 private:
  LineMappingOptions options_;
  std::map<LineId, int> created_at_;  ///< keyframes so far
};

/// Culls keyframes covisible with `keyframe` whose points are nearly all seen by enough others at
/// the same or a finer scale (one octave is no difference). [Mur15] sec. VI-E. Returns how many.
int CullKeyframes(KeyframeId keyframe, const CullingOptions& options, OwnedMap* map);

}  // namespace vpslam
