// What every message must fulfil, sent or received: sizes that agree, finite numbers, sane ranges.
//
// nullopt if the message is sound, else one reason.
#pragma once

#include <optional>
#include <string>

#include "core/features/line_set.h"
#include "core/geometry/camera.h"
#include "core/messages/command.h"
#include "core/messages/frame_features.h"
#include "core/messages/frame_pose.h"
#include "core/messages/keyframe_proposal.h"
#include "core/messages/lines_request.h"
#include "core/messages/map_delta.h"
#include "core/messages/map_request.h"
#include "core/messages/preview.h"
#include "core/messages/process_status.h"
#include "core/messages/run_description.h"
#include "core/messages/truth.h"
#include "core/transport/ack.h"
#include "core/transport/codec.h"
#include "core/transport/image_message.h"

namespace vpslam {

inline constexpr int kMaxImageSide = 16384;         ///< px
inline constexpr std::size_t kMaxFeatures = 65536;  ///< in one image; lines likewise
inline constexpr std::size_t kMaxNameLength = 64;
inline constexpr std::size_t kMaxTextLength = 1024;
inline constexpr std::size_t kMaxOptionsLength = 1 << 20;  ///< they may hold a settings file

using Fault = std::optional<std::string>;

Fault Validate(const Header& header);
Fault Validate(const Camera& camera);
Fault Validate(const ImageMessage& image);
Fault Validate(const FrameFeatures& features);
Fault Validate(const LineSet& lines);
Fault Validate(const LinesRequest& request);
Fault Validate(const FramePose& pose);
Fault Validate(const Truth& truth);
Fault Validate(const KeyframeProposal& keyframe);
Fault Validate(const MapDelta& delta);
Fault Validate(const MapRequest& request);
Fault Validate(const Ack& ack);
Fault Validate(const Command& command);
Fault Validate(const RunDescription& run);
Fault Validate(const ProcessStatus& status);
Fault Validate(const Preview& preview);

/// "/vpslam-" and then letters, digits, '-', '_' or '.'; at most kMaxNameLength in all.
bool IsImageSegmentName(const std::string& name);
/// Letters, digits, '-', '_' or '.'; 1 to kMaxNameLength of them.
bool IsProcessName(const std::string& name);

}  // namespace vpslam
