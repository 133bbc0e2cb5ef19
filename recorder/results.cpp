#include "recorder/results.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/base/json_text.h"
#include "recorder/map_ply.h"
#include "recorder/tables.h"
#include "recorder/trajectory.h"

namespace vpslam {

namespace {

/// What cannot be had again without the run stands first, in case that not all of it fits the disk.
std::vector<std::pair<std::string, std::string>> InOrderOfWorth(
    const std::map<std::string, std::string>& files) {
  const auto rank = [](const std::string& name) {
    if (name == "trajectory.txt") return 0;
    if (name.starts_with("trajectory_map")) return 1;
    if (name == "summary.json") return 2;
    if (name == "keyframes.txt") return 3;
    return name == "map.ply" || name == "preview.jpg" ? 5 : 4;
  };
  std::vector<std::pair<std::string, std::string>> ordered(files.begin(), files.end());
  std::stable_sort(ordered.begin(), ordered.end(),
                   [&](const auto& a, const auto& b) { return rank(a.first) < rank(b.first); });
  return ordered;
}

}  // namespace

std::map<std::string, std::string> MakeResults(const RunRecord& run, const RunInfo& info) {
  std::map<std::string, std::string> files;
  const auto trajectories = FinalTrajectories(run);
  files["trajectory.txt"];  // also where nothing was tracked
  for (size_t i = 0; i < trajectories.size(); ++i) {
    const std::string name = i == 0 ? "trajectory.txt" : fmt::format("trajectory_map{}.txt", i + 1);
    files[name] = FormatTum(trajectories[i].poses);
  }
  const MapId main_map = MainMap(run);
  files["live_trajectory.txt"] = FormatTum(LiveTrajectory(run));
  files["keyframes.txt"] = FormatTum(KeyframeTrajectory(run.map(), main_map));
  files["map.ply"] = MapPly(run.map(), main_map);
  files["frames.csv"] = FramesTable(run);
  files["keyframes.csv"] = KeyframesTable(run);
  if (const auto& jpeg = run.preview().jpeg; !jpeg.empty()) {
    files["preview.jpg"] = std::string(jpeg.begin(), jpeg.end());
  }
  files["summary.json"] = ToText(Summary(run, info), 2) + "\n";
  return files;
}

void WriteResults(const RunRecord& run, const RunInfo& info, const ResultsFolder& folder) {
  const auto files = MakeResults(run, info);
  folder.RemoveStaleMaps(files);
  folder.Write(InOrderOfWorth(files));
}

}  // namespace vpslam
