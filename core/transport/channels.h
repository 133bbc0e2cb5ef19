// The channels of the graph; docs/protocol.md has the table of who sends what to whom.
#pragma once

#include <string>
#include <vector>

namespace vpslam {

inline constexpr const char* kCameraChannel = "CAMERA";
inline constexpr const char* kImageChannel = "IMAGE";
inline constexpr const char* kFeaturesChannel = "FEATURES";
inline constexpr const char* kLinesChannel = "LINES";
inline constexpr const char* kLinesRequestChannel = "LINES_REQUEST";
inline constexpr const char* kPoseChannel = "POSE";
inline constexpr const char* kTruthChannel = "TRUTH";
inline constexpr const char* kKeyframeChannel = "KEYFRAME";
inline constexpr const char* kMapChannel = "MAP";
inline constexpr const char* kRunChannel = "RUN";
inline constexpr const char* kMapRequestChannel = "MAP_REQUEST";
inline constexpr const char* kAckChannel = "ACK";
inline constexpr const char* kCommandChannel = "COMMAND";
inline constexpr const char* kStatusChannel = "STATUS";
inline constexpr const char* kPreviewChannel = "PREVIEW";
inline constexpr const char* kOutcomeChannel = "OUTCOME";

/// Senders count ACK per stream, and COMMAND comes from several places: numbers that are missing
/// there mean nothing.
inline bool HasSequence(const std::string& channel) {
  return channel != kAckChannel && channel != kCommandChannel;
}

/// Who acknowledges the reliable streams, where --require names them.
inline const std::vector<std::string> kImageConsumers = {"frontend"};
inline const std::vector<std::string> kPoseConsumers = {"recorder"};
inline const std::vector<std::string> kKeyframeConsumers = {"backend"};
inline const std::vector<std::string> kMapConsumers = {"frontend", "recorder"};

/// Those of `consumers` that are in `required`: whom a stream has to wait for in this run.
std::vector<std::string> RequiredConsumers(const std::vector<std::string>& consumers,
                                           const std::vector<std::string>& required);

/// `consumers`, and the recorder if `recorded`.
std::vector<std::string> AndRecorderIf(bool recorded, std::vector<std::string> consumers);

}  // namespace vpslam
