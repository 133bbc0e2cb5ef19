// A STATUS message as a line of JSON.
#pragma once

#include <cstdint>
#include <string>

#include "core/messages/process_status.h"

namespace vpslam {

/// {"process", "session", "pid", "state", "rate_hz", ...}: the fields of status_t by their names,
/// the state as a word. A session is a string, since JSON's numbers are doubles elsewhere.
std::string StatusLine(int64_t session, const ProcessStatus& status);

/// "starting", "ready", "running", "finished", "failed"

}  // namespace vpslam
