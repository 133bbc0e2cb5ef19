// The backend: owns the map, works keyframes into it and publishes its changes.
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>
#include <spdlog/spdlog.h>

#include "backend/backend_process.h"
#include "backend/mapper.h"
#include "core/base/priority.h"
#include "core/base/settings.h"
#include "core/transport/process.h"

int main(int argc, char** argv) {
  using namespace vpslam;
  CLI::App app("backend of VP-SLAM: builds the map from keyframes");
  ProcessOptions options;
  options.name = "backend";
  options.required = {"frontend", "recorder"};
  AddProcessOptions(app, &options);
  std::string config;
  std::vector<std::string> overrides;
  app.add_option("--config", config, "settings file; section 'backend' is read");
  app.add_option("--set", overrides, "one setting, over those of the file: backend.key=value");

  return RunProcess(app, argc, argv, &options, [&](Process& process) {
    const auto settings = LoadSettings<MapperOptions>(config, "backend", overrides);
    spdlog::info("settings: {}", PrintSettings(settings));
    cv::setNumThreads(1);  // results must not depend on the number of cores
    // Beside the tracker, mapping takes what time that leaves. The thread that receives messages
    // keeps its priority, and so does a run in which all wait for the map anyway.
    if (options.pace != Pace::kLockstep) LowerPriorityOfThisThread();
    std::unique_ptr<Mapper> mapper;
    const auto make_mapper = [&](const Camera& camera) {
      mapper = std::make_unique<Mapper>(camera, settings);
      return MapperCalls{[&](const KeyframeProposal& keyframe, const IsUrgent& is_urgent) {
                           return mapper->Process(keyframe, is_urgent);
                         },
                         [&] { return mapper->Snapshot(); }, [&] { return mapper->version(); }};
    };
    BackendProcess backend(process.bus, process.peers, process.status, options.required,
                           options.pace, make_mapper);
    backend.Run();
    return kExitOk;
  });
}
