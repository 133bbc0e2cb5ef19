#include "player/outcome.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/base/json_text.h"

namespace vpslam {

nlohmann::ordered_json DescribeOutcome(const SourceReport& report, int64_t played,
                                       const std::string& why_not_sent) {
  int64_t accounted = played;
  auto skipped = nlohmann::ordered_json::object();
  for (const auto& [reason, count] : report.skipped) {
    accounted += count;
    skipped[reason] = count;
  }
  nlohmann::ordered_json outcome = {{"expected", nullptr}, {"played", played}};
  if (report.expected) {
    // A source that is read ahead may have skipped images behind the last that was sent.
    outcome["expected"] = std::max(*report.expected, accounted);
    if (*report.expected > accounted) skipped[why_not_sent] = *report.expected - accounted;
  }
  outcome["skipped"] = skipped;
  if (!report.without_end.empty()) outcome["end_missing"] = report.without_end;
  outcome["notes"] = report.notes;
  return outcome;
}

std::string OutcomeText(nlohmann::ordered_json outcome) {
  constexpr size_t kMaxNotes = 20, kMaxNoteLength = 400;
  auto& notes = outcome["notes"];
  const size_t more = notes.size() > kMaxNotes ? notes.size() - kMaxNotes : 0;
  if (more > 0) {
    notes.erase(notes.begin() + kMaxNotes, notes.end());
    notes.push_back(fmt::format("{} more are in the player's log", more));
  }
  for (auto& note : notes) {
    const auto text = note.get<std::string>();
    if (text.size() > kMaxNoteLength) note = text.substr(0, kMaxNoteLength) + " ...";
  }
  return ToText(outcome);
}

std::string OutcomeLine(const nlohmann::ordered_json& outcome) {
  std::string line = fmt::format("played {} of ", outcome["played"].get<int64_t>());
  if (outcome.contains("end_missing")) line += "at least ";
  line += outcome["expected"].is_null() ? "unknown" : outcome["expected"].dump();
  line += " images";
  std::string separator = ": ";
  for (const auto& [reason, count] : outcome["skipped"].items()) {
    line += fmt::format("{}{} skipped ({})", separator, count.get<int64_t>(), reason);
    separator = ", ";
  }
  if (outcome.contains("end_missing")) {
    line += fmt::format("{}the rest skipped ({})", separator,
                        outcome["end_missing"].get<std::string>());
  }
  return line;
}

}  // namespace vpslam
