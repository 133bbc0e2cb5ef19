// What a log of messages holds, without playing it.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace vpslam {

/// {"events", "damaged_bytes", "damaged_places", "duration_s",
///  "run": {"seed", "commit", "options"}, "camera": {"width", "height"},
///  "channels": {name: {"messages", "missing", "repeated", "ended", "bytes"}}}
///
/// `missing` counts sequence numbers left out, over all senders of the channel; null where senders
/// do not number their messages per channel (ACK, COMMAND). `run` and `camera` are null where the
/// log has none; `damaged_bytes` belong to no whole message. Throws std::runtime_error with one
/// line if it is no log.
nlohmann::ordered_json SummarizeLog(const std::string& path);

}  // namespace vpslam
