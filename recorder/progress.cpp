#include "recorder/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>

#include <nlohmann/json.hpp>

#include "core/base/json_text.h"
#include "core/messages/state_names.h"

namespace vpslam {
namespace {

/// Without a pose for so long, what was measured before holds no more.
constexpr double kIdle_s = 2;

/// Frames per second by the times at which their images went out, over the last second.
double FramesPerSecond(const RunRecord& run) {
  const auto& frames = run.frames();
  if (frames.empty()) return 0;
  const int64_t end_us = frames.rbegin()->second.last.image_published_us;
  int64_t begin_us = end_us;
  int count = 0;
  for (auto frame = std::next(frames.rbegin()); frame != frames.rend(); ++frame) {
    const int64_t published_us = frame->second.last.image_published_us;
    if (published_us < end_us - 1'000'000) break;
    begin_us = published_us;
    ++count;
  }
  return begin_us < end_us ? 1e6 * count / static_cast<double>(end_us - begin_us) : 0;
}

/// Frames without a pose since the last that had one, where there is a map.
int64_t FramesLost(const RunRecord& run) {
  const auto& frames = run.frames();
  const auto found = std::find_if(frames.rbegin(), frames.rend(), [](const auto& frame) {
    return frame.second.last.state != TrackingState::kLost;
  });
  return std::distance(frames.rbegin(), found);
}

}  // namespace

std::string ProgressLine(const RunRecord& run, double idle_s) {
  const auto& frames = run.frames();
  const FramePose newest = frames.empty() ? FramePose() : frames.rbegin()->second.last;
  const int64_t frame = frames.empty() ? -1 : newest.frame_seq;
  const double fps = idle_s > kIdle_s ? 0 : FramesPerSecond(run);
  nlohmann::ordered_json line = {{"frame", frame},
                                 {"fps", std::round(10 * fps) / 10},
                                 {"state", StateName(newest.state)},
                                 {"map", newest.map.value},
                                 {"maps", run.map().Maps().size()},
                                 {"maps_merged", run.map().num_merged()},
                                 {"frames_lost", FramesLost(run)},
                                 {"keyframes", run.map().NumKeyframes(newest.map)},
                                 {"points", run.map().NumPoints(newest.map)},
                                 {"dropped", frame + 1 - static_cast<int64_t>(frames.size())},
                                 {"processes", nlohmann::ordered_json::object()},
                                 {"messages", nlohmann::ordered_json::object()}};
  for (const auto& [key, status] : run.processes()) {
    line["processes"][status.process] = StateName(status.state);
    const bool is_up =
        status.state == ProcessState::kReady || status.state == ProcessState::kRunning;
    if (is_up && !status.message.empty()) line["messages"][status.process] = status.message;
  }
  return ToText(line);
}

}  // namespace vpslam
