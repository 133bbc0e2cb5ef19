// The frontend: tracks each image in a replica of the map and proposes keyframes.
#include <cstdint>
#include <memory>

#include <CLI/CLI.hpp>
#include <opencv2/core.hpp>

#include "core/transport/process.h"
#include "frontend/frontend_process.h"
#include "frontend/tracker.h"

int main(int argc, char** argv) {
  using namespace vpslam;
  CLI::App app("frontend of VP-SLAM: tracks images, proposes keyframes");
  ProcessOptions options;
  options.name = "frontend";
  options.required = {"backend", "recorder"};
  AddProcessOptions(app, &options);
  uint64_t seed = 1;
  app.add_option("--seed", seed, "seed of the random numbers")->capture_default_str();

  return RunProcess(app, argc, argv, &options, [&](Process& process) {
    cv::setNumThreads(1);  // results must not depend on the number of cores
    std::unique_ptr<Tracker> tracker;
    const auto make_tracker = [&](const Camera& camera) {
      tracker = std::make_unique<Tracker>(camera, TrackerOptions(), seed);
      return TrackerCalls{[&](const ImageFrame& image) { return tracker->Track(image); },
                          [&](const MapDelta& delta) { return tracker->Apply(delta); },
                          [&] { return tracker->Finish(); },
                          [&] { return tracker->map_version(); }};
    };
    FrontendProcess frontend(process.bus, process.peers, process.status, options.required,
                             make_tracker);
    frontend.Run();
    return kExitOk;
  });
}
