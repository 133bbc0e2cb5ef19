// The figures of a run: summary.json, and the launcher's progress line.
#pragma once

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "recorder/run_record.h"

namespace vpslam {

/// What the summary repeats of how the run was started.
struct RunInfo {
  nlohmann::ordered_json options = nlohmann::ordered_json::object();
  int64_t seed = 0;
  std::string commit;
  nlohmann::ordered_json log;  ///< of what was recorded: messages and gaps per channel; or null
};

/// Counts are those of all maps together; tracked frames are those that have a pose in one of the
/// trajectories. A figure that nothing was measured for is null.
nlohmann::ordered_json Summary(const RunRecord& run, const RunInfo& info);

}  // namespace vpslam
