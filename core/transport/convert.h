// Between the structs that the system computes with and those that lcm-gen made.
//
// ToWire expects a value that Validate accepts. FromWire gives nullopt and the reason for anything
// else; it copies numbers bit by bit.
#pragma once

#include <optional>
#include <string>

#include "core/transport/validate.h"
#include "lcmtypes/vpslam/ack_t.hpp"
#include "lcmtypes/vpslam/camera_t.hpp"
#include "lcmtypes/vpslam/command_t.hpp"
#include "lcmtypes/vpslam/features_t.hpp"
#include "lcmtypes/vpslam/image_t.hpp"
#include "lcmtypes/vpslam/keyframe_t.hpp"
#include "lcmtypes/vpslam/lines_request_t.hpp"
#include "lcmtypes/vpslam/lines_t.hpp"
#include "lcmtypes/vpslam/map_delta_t.hpp"
#include "lcmtypes/vpslam/map_request_t.hpp"
#include "lcmtypes/vpslam/pose_t.hpp"
#include "lcmtypes/vpslam/preview_t.hpp"
#include "lcmtypes/vpslam/run_t.hpp"
#include "lcmtypes/vpslam/status_t.hpp"
#include "lcmtypes/vpslam/truth_t.hpp"

namespace vpslam {

camera_t ToWire(const Camera& camera);
image_t ToWire(const ImageMessage& image);
features_t ToWire(const FrameFeatures& features);
lines_t ToWire(const LineSet& lines);
lines_request_t ToWire(const LinesRequest& request);
pose_t ToWire(const FramePose& pose);
truth_t ToWire(const Truth& truth);
keyframe_t ToWire(const KeyframeProposal& keyframe);
map_delta_t ToWire(const MapDelta& delta);
map_request_t ToWire(const MapRequest& request);
ack_t ToWire(const Ack& ack);
command_t ToWire(const Command& command);
run_t ToWire(const RunDescription& run);
status_t ToWire(const ProcessStatus& status);
preview_t ToWire(const Preview& preview);

std::optional<Camera> FromWire(const camera_t& wire, std::string* why);
std::optional<ImageMessage> FromWire(const image_t& wire, std::string* why);
std::optional<FrameFeatures> FromWire(const features_t& wire, std::string* why);
std::optional<LineSet> FromWire(const lines_t& wire, std::string* why);
std::optional<LinesRequest> FromWire(const lines_request_t& wire, std::string* why);
std::optional<FramePose> FromWire(const pose_t& wire, std::string* why);
std::optional<Truth> FromWire(const truth_t& wire, std::string* why);
std::optional<KeyframeProposal> FromWire(const keyframe_t& wire, std::string* why);
std::optional<MapDelta> FromWire(const map_delta_t& wire, std::string* why);
std::optional<MapRequest> FromWire(const map_request_t& wire, std::string* why);
std::optional<Ack> FromWire(const ack_t& wire, std::string* why);
std::optional<Command> FromWire(const command_t& wire, std::string* why);
std::optional<RunDescription> FromWire(const run_t& wire, std::string* why);
std::optional<ProcessStatus> FromWire(const status_t& wire, std::string* why);
std::optional<Preview> FromWire(const preview_t& wire, std::string* why);

}  // namespace vpslam
