#include "recorder/summary.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

#include "recorder/stages.h"
#include "recorder/trajectory.h"

namespace vpslam {
namespace {

using Json = nlohmann::ordered_json;

/// Three decimals: what is measured here is not known better.
Json Rounded(std::optional<double> value) {
  if (!value || !std::isfinite(*value)) return nullptr;
  return std::round(*value * 1000) / 1000;
}

Json Frames(const RunRecord& run) {
  const auto& frames = run.frames();
  const auto measured = [](const auto& f) { return IsMeasured(f.second.last); };
  const auto first = std::find_if(frames.begin(), frames.end(), measured);
  const int64_t in = run.frames_in();
  const auto processed = static_cast<int64_t>(frames.size());
  const int64_t first_tracked = first == frames.end() ? in : first->first;
  size_t tracked = 0;
  for (const MapTrajectory& t : FinalTrajectories(run)) tracked += t.poses.size();
  const int64_t processed_before = std::distance(frames.begin(), first);
  return {{"in", in},
          {"processed", processed},
          {"dropped", in - processed},
          {"dropped_before_init", first_tracked - processed_before},
          {"tracked", tracked}};
}

/// How many of the images that were played have no pose in the end, by the reason.
Json NoPose(const RunRecord& run) {
  Json reasons = Json::object();
  const auto count = [&](const char* reason, int64_t images) {
    if (images > 0) reasons[reason] = reasons.value(reason, int64_t{0}) + images;
  };
  count("dropped", run.frames_in() - static_cast<int64_t>(run.frames().size()));
  for (const auto& [seq, frame] : run.frames()) {
    const FramePose& pose = frame.last;
    if (HasFinalPose(run, pose)) continue;
    switch (pose.state) {
      case TrackingState::kInitialising:
        count("before a map was started", 1);
        break;
      case TrackingState::kLost:
        count("lost", 1);
        break;
      case TrackingState::kTracking:
        count(IsMeasured(pose) ? "in a map that was given up" : "without enough of the map in view",
              1);
        break;
    }
  }
  return reasons;
}

/// What the player says of the images of the sequence; null where it has not ended yet.
Json Sequence(const RunRecord& run) {
  const Json sequence = Json::parse(run.outcome().json, nullptr, /*allow_exceptions=*/false);
  return sequence.is_object() && !sequence.empty() ? sequence : Json();
}

Json StageMedians(const RunRecord& run) {
  Json medians = Json::object();
  for (const auto& stage : kTrackingStages) {
    std::vector<double> ms;
    for (const auto& [seq, frame] : run.frames()) {
      if (frame.live) ms.push_back(frame.live->times.*stage.ms);
    }
    medians[stage.name] = Rounded(Quantile(std::move(ms), 0.5));
  }
  for (const auto& stage : kMappingStages) {
    std::vector<double> ms;
    for (const auto& [id, keyframe] : run.keyframes()) ms.push_back(keyframe.times.*stage.ms);
    const bool is_total = std::string_view(stage.name) == "total";
    medians[is_total ? "mapping_total" : stage.name] = Rounded(Quantile(std::move(ms), 0.5));
  }
  return medians;
}

Json Latency(const RunRecord& run) {
  std::vector<double> total_ms;
  for (const auto& [seq, frame] : run.frames()) {
    if (frame.live) total_ms.push_back(frame.live->times.total_ms);
  }
  return {{"median", Rounded(Quantile(total_ms, 0.5))}, {"p95", Rounded(Quantile(total_ms, 0.95))}};
}

/// What each process says of the messages that it worked on, and of those that did not come to be.
Json Messages(const RunRecord& run) {
  Json messages = Json::object();
  for (const auto& [key, status] : run.processes()) {
    Json& own = messages[status.process];
    if (own.is_null()) own = Json::object();
    const auto add = [&own](const char* name, int64_t count) {
      own[name] = own.value(name, int64_t{0}) + count;
    };
    add("processed", status.processed);
    add("dropped", status.dropped);
    add("gaps", status.gaps);
    add("rejected", status.rejected);
    add("resent", status.resent);
  }
  return messages;
}

}  // namespace

Json Summary(const RunRecord& run, const RunInfo& info) {
  const double processed = static_cast<double>(run.frames().size());
  std::map<std::string, double> cpu_s, rss_mb;
  for (const auto& [key, status] : run.processes()) {
    cpu_s[status.process] += status.cpu_s;
    rss_mb[status.process] = std::max(rss_mb[status.process], status.rss_peak_mb);
  }
  Json cpu = Json::object(), rss = Json::object();
  double total_s = 0;
  const auto per_frame = [&](double s) {
    return Rounded(processed > 0 ? std::optional(1e3 * s / processed) : std::nullopt);
  };
  for (const auto& [name, s] : cpu_s) {
    cpu[name] = per_frame(s);
    total_s += s;
  }
  cpu["total"] = per_frame(total_s);
  for (const auto& [name, mb] : rss_mb) rss[name] = Rounded(mb);

  Json summary = {{"frames", Frames(run)},
                  {"no_pose", NoPose(run)},
                  {"latency_ms", Latency(run)},
                  {"cpu_ms_per_frame", cpu},
                  {"messages", Messages(run)},
                  {"stages_ms", StageMedians(run)},
                  {"maps", run.map().Maps().size()},
                  {"keyframes", run.map().keyframes().size()},
                  {"points", run.map().points().size()},
                  {"lines", run.map().lines().size()},
                  {"wall_s", Rounded(run.wall_s())},
                  {"peak_rss_mb", rss},
                  {"options", info.options},
                  {"seed", info.seed},
                  {"commit", info.commit}};
  if (const Json sequence = Sequence(run); !sequence.is_null()) summary["sequence"] = sequence;
  if (!info.log.is_null()) summary["log"] = info.log;
  return summary;
}

}  // namespace vpslam
