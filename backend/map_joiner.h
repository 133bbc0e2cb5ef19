// Two maps turn out to show one place, at a seam: a keyframe of the one that was found in the other
// as well. Sim(3) between them from the points that both have, one map brought over into the other,
// points that are the same fused, and bundle adjustment across the seam.
//
// The similarity minimises reprojection errors of what the keyframe of the seam sees of the other
// map, and of common points in the keyframes of the *other* map that see them, both ways: the
// keyframe of the seam alone cannot tell the scale.
#pragma once

#include <optional>

#include "backend/keyframe_store.h"
#include "backend/mapper_options.h"
#include "core/features/scale_levels.h"
#include "core/geometry/camera.h"
#include "core/geometry/sim3.h"
#include "core/map/map.h"
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
std::optional<SeamAlignment> AlignSeam(KeyframeId keyframe, const MapSeam& seam,
                                       const Camera& camera, const ScalePyramid& scales,
                                       const KeyframeStore& store, const MergingOptions& options,
                                       const Map& map);

struct Merger {
  MapId from, into;
  Sim3 into_from;
};

/// Brings the younger map into the older one's coordinates and into it, and fuses the points.
Merger JoinMaps(KeyframeId keyframe, const SeamAlignment& alignment, MapId there, Map* map);

}  // namespace vpslam
