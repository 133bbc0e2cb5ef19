// Two maps turn out to show one place, at a seam: a keyframe of the one that was found in the other
// as well. Sim(3) between them from the points that both have, one map brought over into the other,
// points that are the same fused, and bundle adjustment across the seam.
//
// The similarity minimises reprojection errors of what the keyframe of the seam sees of the other
// map, and of common points in the keyframes of the *other* map that see them, both ways: the
// keyframe of the seam alone cannot tell the scale.
#pragma once

#include <optional>
#include <vector>

#include "backend/mapper_options.h"
#include "backend/mapping_context.h"
#include "core/geometry/sim3.h"
#include "core/messages/keyframe_proposal.h"

namespace vpslam {

/// A point that both maps have, each as its own.
struct CommonPoint {
  PointId here;   ///< in the keyframe's map
  PointId there;  ///< in the seam's
};

struct SeamAlignment {
  Sim3 there_from_here;
  std::vector<CommonPoint> points;  ///< that agree with it
};

/// nullopt if too few points are common, or too few of them agree.
std::optional<SeamAlignment> AlignSeam(const MappingContext& context, KeyframeId keyframe,
                                       const MapSeam& seam, const MergingOptions& options);

struct Merger {
  MapId from, into;
  Sim3 into_from;
};

/// All that a map has, to be found again when it has become part of another.
struct MapContents {
  std::vector<KeyframeId> keyframes;
  std::vector<PointId> points;
  std::vector<LineId> lines;
};

MapContents ContentsOf(MapId id, const Map& map);

/// Moves what is left of it.
void Transform(const MapContents& contents, const SE3& new_from_old, OwnedMap* map);

/// The younger map goes into the older one.
Merger MergerOf(MapId here, MapId there, const Sim3& there_from_here);

/// Brings one map into the other's coordinates and into it, and fuses the points.
void JoinMaps(const Merger& merger, const std::vector<CommonPoint>& common, OwnedMap* map);

}  // namespace vpslam
