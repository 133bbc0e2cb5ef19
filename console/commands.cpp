#include "console/commands.h"

#include <array>
#include <sstream>

#include "core/messages/names.h"
#include "core/messages/validate.h"

namespace vpslam {
namespace {

struct Word {
  const char* name;
  const char* target;
  CommandAction action;
  enum class Value { kNone, kOptional, kNeeded } value = Value::kNone;
};

constexpr std::array kWords = {
    Word{"pause", "player", CommandAction::kPause},
    Word{"resume", "player", CommandAction::kResume},
    Word{"step", "player", CommandAction::kStep, Word::Value::kOptional},
    Word{"rate", "player", CommandAction::kSetRate, Word::Value::kNeeded},
    Word{"stop", "player", CommandAction::kStop},
    Word{"camera", "player", CommandAction::kSendCamera},
    Word{"show", "frontend", CommandAction::kShow},
    Word{"save", "recorder", CommandAction::kSaveNow},
};

}  // namespace

std::vector<std::string> CommandNames() {
  std::vector<std::string> names;
  for (const Word& word : kWords) names.emplace_back(word.name);
  return names;
}

std::optional<Command> ParseCommand(const std::string& text, std::string* why) {
  std::istringstream words(text);
  std::string name, rest;
  words >> name;
  for (const Word& word : kWords) {
    if (name != word.name) continue;
    Command command{word.target, word.action};
    const bool has_value = static_cast<bool>(words >> command.value);
    if (!has_value) {
      words.clear();
      command.value = word.action == CommandAction::kStep ? 1 : 0;
    }
    if ((words >> rest) || (has_value && word.value == Word::Value::kNone)) {
      *why = "'" + text + "' has more than it takes";
    } else if (!has_value && word.value == Word::Value::kNeeded) {
      *why = "'" + name + "' needs a number behind it";
    } else if (const auto fault = Validate(command)) {
      *why = "'" + text + "': " + *fault;
    } else {
      return command;
    }
    return std::nullopt;
  }
  *why = "'" + name + "' is no command; there are";
  for (const Word& word : kWords) *why += std::string(" ") + word.name;
  return std::nullopt;
}

}  // namespace vpslam
