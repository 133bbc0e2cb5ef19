#include "recorder/results.h"

#include <fmt/format.h>

#include "core/base/json_text.h"
#include "recorder/map_ply.h"
#include "recorder/tables.h"
#include "recorder/trajectory.h"

namespace vpslam {

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
  folder.Write(files);
  folder.RemoveStaleMaps(files);
}

}  // namespace vpslam
