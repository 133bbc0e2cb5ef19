// The frontend: tracks each image in a replica of the map and proposes keyframes.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>
#include <spdlog/spdlog.h>

#include "core/base/settings.h"
#include "core/transport/process.h"
#include "frontend/frontend_process.h"
#include "frontend/tracker.h"
#include "frontend/tracker_settings.h"

int main(int argc, char** argv) {
  using namespace vpslam;
  CLI::App app("frontend of VP-SLAM: tracks images, proposes keyframes");
  ProcessOptions options;
  options.name = "frontend";
  options.required = {"backend", "recorder"};
  AddProcessOptions(app, &options);
  std::string config;
  std::vector<std::string> overrides;
  app.add_option("--config", config, "settings file; section 'frontend' is read");
  app.add_option("--set", overrides, "one setting, over those of the file: frontend.key=value");
  FrontendStreams streams;
  app.add_flag("--take-features", streams.take_features,
               "track the features that a player replays, instead of images");
  app.add_flag("--preview", streams.always_preview, "publish previews without being asked");
  uint64_t seed = 1;
  app.add_option("--seed", seed, "seed of the random numbers")->capture_default_str();

  return RunProcess(app, argc, argv, &options, [&](Process& process) {
    const auto settings = LoadSettings<TrackerOptions>(config, "frontend", overrides);
    spdlog::info("settings: {}", PrintSettings(settings));
    cv::setNumThreads(1);  // results must not depend on the number of cores
    std::unique_ptr<Tracker> tracker;
    const auto make_tracker = [&](const Camera& camera) -> TrackerInterface& {
      tracker = std::make_unique<Tracker>(camera, settings, seed);
      return *tracker;
    };
    streams.recorded = options.IsRecorded();
    std::optional<LineSourceOptions> lines;
    if (!streams.take_features && std::find(options.required.begin(), options.required.end(),
                                            LineSource::kDetector) != options.required.end()) {
      lines = LineSourceOptions::ForPace(options.pace);
    }
    FrontendProcess frontend(process.bus, process.peers, process.status, options.required,
                             make_tracker, lines, options.pace, streams);
    frontend.Run();
    return kExitOk;
  });
}
