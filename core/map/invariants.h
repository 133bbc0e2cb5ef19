// What holds in every map, at every time.
#pragma once

#include <optional>
#include <string>

#include "core/map/map.h"

namespace vpslam {

/// The first rule found broken, in words; nullopt if all hold. Costs a walk over the whole map.
///
/// - Observations stand on both sides, ascending by keyframe; landmark and observer are of one map.
/// - Covisibility counts are those of the observations.
/// - The parent of a keyframe is older and lives in the same map; that of a culled one exists.
/// - A line has an axis if and only if it names a Manhattan frame, which exists, in its own map;
/// the
///   frame that a keyframe names does so, too.
/// - What was seen has as many features and segments as there are places for observations at most.
/// - Numbers are finite, rotations have length 1, units are positive.
std::optional<std::string> CheckInvariants(const Map& map);

}  // namespace vpslam
