// Commands as people type them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/messages/command.h"

namespace vpslam {

/// "pause", "resume", "step 5", "rate 0.5", "stop", "save", "camera", "show": the command,
/// addressed to the process that obeys it. nullopt, with one line on what is wrong, for others.
std::optional<Command> ParseCommand(const std::string& text, std::string* why);

/// The words that ParseCommand knows.
std::vector<std::string> CommandNames();

}  // namespace vpslam
