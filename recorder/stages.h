// The columns of times that tables and summary share.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "core/messages/stages.h"

namespace vpslam {

template <class Times>
struct Stage {
  const char* name;  ///< column `name`_ms
  double Times::*ms;
};

inline constexpr std::array kTrackingStages = {
    Stage<TrackingTimes>{"decode", &TrackingTimes::decode_ms},
    Stage<TrackingTimes>{"transport", &TrackingTimes::transport_ms},
    Stage<TrackingTimes>{"features", &TrackingTimes::features_ms},
    Stage<TrackingTimes>{"lines", &TrackingTimes::lines_ms},
    Stage<TrackingTimes>{"vps", &TrackingTimes::vps_ms},
    Stage<TrackingTimes>{"wait_for_lines", &TrackingTimes::wait_for_lines_ms},
    Stage<TrackingTimes>{"initial_pose", &TrackingTimes::initial_pose_ms},
    Stage<TrackingTimes>{"rotation", &TrackingTimes::rotation_ms},
    Stage<TrackingTimes>{"translation", &TrackingTimes::translation_ms},
    Stage<TrackingTimes>{"local_map", &TrackingTimes::local_map_ms},
    Stage<TrackingTimes>{"total", &TrackingTimes::total_ms},
};

inline constexpr std::array kMappingStages = {
    Stage<MappingTimes>{"insertion", &MappingTimes::insertion_ms},
    Stage<MappingTimes>{"feature_culling", &MappingTimes::feature_culling_ms},
    Stage<MappingTimes>{"feature_creation", &MappingTimes::feature_creation_ms},
    Stage<MappingTimes>{"keyframe_culling", &MappingTimes::keyframe_culling_ms},
    Stage<MappingTimes>{"local_ba", &MappingTimes::local_ba_ms},
    Stage<MappingTimes>{"total", &MappingTimes::total_ms},
};

/// The value below which the share `quantile` of the finite values lies, interpolated between
/// neighbours; nullopt if there are none.
std::optional<double> Quantile(std::vector<double> values, double quantile);

}  // namespace vpslam
