// What became of the images of a sequence, as the player tells it in the end.
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "player/image_source.h"

namespace vpslam {

/// {"expected": images that there should have been, or null, "played": images sent, "skipped":
/// {reason: images}, "end_missing": why it is not known how many more there were, or left out,
/// "notes": [lines]}. `played` of the images were sent; what neither the source nor this accounts
/// for was not sent for the reason `why_not_sent`.
nlohmann::ordered_json DescribeOutcome(const SourceReport& report, int64_t played,
                                       const std::string& why_not_sent);

/// As the text of a message, in which only so many notes, shortened, have room.
std::string OutcomeText(nlohmann::ordered_json outcome);

/// "played 57 of 60 images: 3 skipped (is truncated)"
std::string OutcomeLine(const nlohmann::ordered_json& outcome);

}  // namespace vpslam
